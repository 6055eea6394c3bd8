# Manual pages and completion, from the tables that sweepd reads its command line and settings by.
add_executable(sweepd_manual commands/write_manual.cpp)
target_link_libraries(sweepd_manual PRIVATE sweepd_options sweepd_daemon)
target_compile_definitions(sweepd_manual PRIVATE SWEEPD_VERSION="${PROJECT_VERSION}")
set(manual ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual})

# They are dated as the newest entry of the changelog.
set(changelog ${PROJECT_SOURCE_DIR}/config/debian/changelog)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${changelog})
file(STRINGS ${changelog} released REGEX "^ -- " LIMIT_COUNT 1)
string(REGEX MATCH "([0-9]+) ([A-Z][a-z]+) ([0-9]+)" released "${released}")
string(FIND "JanFebMarAprMayJunJulAugSepOctNovDec" "${CMAKE_MATCH_2}" month)
math(EXPR month "${month} / 3 + 101")
string(SUBSTRING "${month}" 1 2 month)
set(released "${CMAKE_MATCH_3}-${month}-${CMAKE_MATCH_1}")

add_custom_command(
  OUTPUT ${manual}/sweepd.1.gz ${manual}/sweepd.toml.5.gz ${manual}/sweepd.bash
  BYPRODUCTS ${manual}/sweepd.1 ${manual}/sweepd.toml.5
  COMMAND sweepd_manual ${CMAKE_CURRENT_SOURCE_DIR}/commands ${manual} ${released}
  COMMAND gzip -9nkf ${manual}/sweepd.1 ${manual}/sweepd.toml.5
  DEPENDS sweepd_manual commands/sweepd.1.in commands/sweepd.toml.5.in
  VERBATIM)
add_custom_target(manual ALL DEPENDS ${manual}/sweepd.1.gz)
install(FILES ${manual}/sweepd.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${manual}/sweepd.toml.5.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man5)
install(FILES ${manual}/sweepd.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME sweepd)
