# Installs the settings and what makes sweepd a service. Runs while installing, since only then the
# prefix is known: settings belong into /etc for /usr, into PREFIX/etc for any other. Settings that are
# there already stay as they are.
if(NOT IS_ABSOLUTE "${sysconfdir}")
  string(CONCAT sysconfdir "${CMAKE_INSTALL_PREFIX}/" "${sysconfdir}")
  string(REGEX REPLACE "^/usr/etc" "/etc" sysconfdir "${sysconfdir}")
endif()
set(settings ${sysconfdir}/sweepd)
set(config ${CMAKE_CURRENT_LIST_DIR})

file(GLOB_RECURSE files RELATIVE ${config}
     ${config}/sweepd.toml ${config}/collect.toml ${config}/watch.toml ${config}/facts.toml
     ${config}/robots/* ${config}/plans/* ${config}/controller/*)
foreach(file IN LISTS files)
  if(EXISTS "$ENV{DESTDIR}${settings}/${file}")
    message(STATUS "Left as it is: $ENV{DESTDIR}${settings}/${file}")
  else()
    get_filename_component(folder ${settings}/${file} DIRECTORY)
    file(INSTALL ${config}/${file} DESTINATION ${folder})
  endif()
endforeach()

foreach(name sweepd.service sweepd-publish.service sweepd-collect.service sweepd-watch@.service)
  file(READ ${config}/systemd/${name} unit)
  string(REPLACE "/usr/bin/sweepd" "${CMAKE_INSTALL_PREFIX}/bin/sweepd" unit "${unit}")
  string(REPLACE "/etc/sweepd/" "${settings}/" unit "${unit}")
  file(WRITE ${binary_dir}/systemd/${name} "${unit}")
  file(INSTALL ${binary_dir}/systemd/${name} DESTINATION ${CMAKE_INSTALL_PREFIX}/lib/systemd/system)
endforeach()
file(INSTALL ${config}/systemd/sweepd.sysusers
     DESTINATION ${CMAKE_INSTALL_PREFIX}/lib/sysusers.d RENAME sweepd.conf)
file(INSTALL ${config}/debian/needrestart.conf
     DESTINATION ${sysconfdir}/needrestart/conf.d RENAME sweepd.conf)
