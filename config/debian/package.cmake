# cpack makes sweepd_VERSION_ARCHITECTURE.deb. scripts/package does it all, and tries it.
set(debian ${CMAKE_CURRENT_LIST_DIR})
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sweepd)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "sweepd maintainers <maintainers@sweepd.invalid>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "answer KUKA RSI and identify the robot's DH parameters")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"sweepd runs beside a KUKA robot controller, in place of RSIMonitor. It answers
the telegrams of the Robot Sensor Interface (RSI) in time, records every one of
them, and identifies the Denavit-Hartenberg parameters of the robot, with their
uncertainties, from sweeps of single joints.

The package has the daemon with its systemd unit, commands to replay, inspect
and export captures, a simulated controller, descriptions of KUKA robots, and
what is copied onto the controller. On many machines, results go to an MQTT
broker and into PostgreSQL.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# passwd creates the user where there is no systemd-sysusers; procps has the kill of ExecReload.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "passwd, procps")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "chromium, mosquitto, postgresql")  # prints reports as PDF; where many machines tell their results
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    ${debian}/postinst ${debian}/prerm ${debian}/postrm ${PROJECT_BINARY_DIR}/debian/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${debian}/before_packing.cmake)
set(CPACK_SWEEPD_CONFFILES ${PROJECT_BINARY_DIR}/debian/conffiles)
set(CPACK_VERBATIM_VARIABLES ON)
file(WRITE ${CPACK_SWEEPD_CONFFILES} "")  # to be filled in then
include(CPack)

# What every Debian package has in its documentation folder, and the pages: not compressed, since they
# link to each other.
find_program(GZIP gzip REQUIRED)
set(documentation ${PROJECT_BINARY_DIR}/documentation)
file(MAKE_DIRECTORY ${documentation})
add_custom_command(
  OUTPUT ${documentation}/changelog.gz
  COMMAND ${GZIP} -9nc ${debian}/changelog > ${documentation}/changelog.gz
  DEPENDS ${debian}/changelog)
add_custom_target(documentation ALL DEPENDS ${documentation}/changelog.gz)
install(FILES ${documentation}/changelog.gz ${debian}/copyright
              ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
              ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md ${PROJECT_SOURCE_DIR}/SECURITY.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR}
        FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png" PATTERN "*.json" PATTERN "*.py" PATTERN "*.m"
                       PATTERN "*.dat")
install(FILES ${PROJECT_SOURCE_DIR}/config/controller/README.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/config/controller)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/monitoring DESTINATION ${CMAKE_INSTALL_DOCDIR}/config)
install(FILES ${debian}/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
        RENAME sweepd)
