# Doxygen input filter: adds the declarations of a public header to the group of its room, without adding lines. With the using
# directive, Doxygen also resolves type names on the group's page.
NR == 1 { split(FILENAME, part, "/include/osteomill/"); room = part[2]; sub(/\/.*/, "", room); printf "/** @file */ " }
/^namespace osteomill(::[a-z_]+)? \{$/ && !open { print $0 " /** @addtogroup " room " */ /** @{ */"; open = 1; next }
/^}  \/\/ namespace osteomill/ && open { print "/** @} */ " $0 " \n using namespace osteomill;"; open = 0; next }
{ print }
