# Runs in CPack after the files of every package are in place: compresses the manual pages, and adds the documents that Debian's
# policy requires for each package. SOURCE_DATE_EPOCH is the changelog's date.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} COMPONENT)
  set(package ${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
  set(share ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share)
  set(documents ${share}/doc/${package})
  file(COPY ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${documents})
  # The copyright file contains it.
  file(REMOVE ${documents}/LICENSE)
  file(WRITE ${documents}/changelog.Debian "osteomill (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * New version; changelog.gz of the package osteomill lists the changes.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  if(EXISTS ${documents}/CHANGELOG.md)
    file(RENAME ${documents}/CHANGELOG.md ${documents}/changelog)
  endif()
  file(GLOB compressed ${share}/man/man1/*.1 ${documents}/changelog*)
  execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
