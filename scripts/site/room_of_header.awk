# Doxygen's input filter: puts what a public header declares into the group of its room, on the lines that are there. With
# the using directive, Doxygen also finds types that it names on the group's page.
NR == 1 { split(FILENAME, part, "/include/osteomill/"); room = part[2]; sub(/\/.*/, "", room); printf "/** @file */ " }
/^namespace osteomill(::[a-z_]+)? \{$/ && !open { print $0 " /** @addtogroup " room " */ /** @{ */"; open = 1; next }
/^}  \/\/ namespace osteomill/ && open { print "/** @} */ " $0 " \n using namespace osteomill;"; open = 0; next }
{ print }
