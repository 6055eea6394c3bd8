# Manual pages and completion, from what sweepd says of itself.
find_program(HELP2MAN help2man REQUIRED)
set(manual ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual})
# A page for each command. A name with a hyphen has an underscore in that of its file.
file(GLOB commands RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/commands CONFIGURE_DEPENDS commands/*_command.cpp)
list(TRANSFORM commands REPLACE "_command\\.cpp$" "")
list(TRANSFORM commands REPLACE "_" "-")
list(TRANSFORM commands REPLACE "(.+)" "${manual}/sweepd-\\1.1.gz" OUTPUT_VARIABLE pages)
list(PREPEND pages ${manual}/sweepd.1.gz)
# They are dated as the newest entry of the changelog.
set(changelog ${PROJECT_SOURCE_DIR}/config/debian/changelog)
set(written ${CMAKE_CURRENT_SOURCE_DIR}/commands)

add_custom_command(
  OUTPUT ${pages} ${manual}/sweepd.toml.5.gz ${manual}/sweepd.bash
  COMMAND sh ${written}/write_manual.sh $<TARGET_FILE:sweepd> ${written} ${manual} ${changelog} ${commands}
  DEPENDS sweepd ${changelog} ${written}/write_manual.sh ${written}/sweepd.1.in
    ${written}/sweepd-command.1.in ${written}/sweepd.toml.5.in
  VERBATIM)
add_custom_target(manual ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${manual}/sweepd.toml.5.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man5)
install(FILES ${manual}/sweepd.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME sweepd)
