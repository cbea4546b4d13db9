# Doxygen input filter: adds the declarations of a public header to the group of its module, without adding lines. With the using
# directive, Doxygen also resolves type names on the group's page.
NR == 1 { split(FILENAME, part, "/include/osteomill/"); module = part[2]; sub(/\/.*/, "", module); printf "/** @file */ " }
/^namespace osteomill(::[a-z_]+)? \{$/ && !open { print $0 " /** @addtogroup " module " */ /** @{ */"; open = 1; next }
/^}  \/\/ namespace osteomill/ && open { print "/** @} */ " $0 " \n using namespace osteomill;"; open = 0; next }
{ print }
