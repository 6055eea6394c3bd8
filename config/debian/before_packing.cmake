# Between installation into the package's folder and packing it: lists the settings as conffiles, so
# that an upgrade keeps what was edited; makes folders readable whatever the umask; and gives all files
# one time if SOURCE_DATE_EPOCH is set, so that the same sources give the same package.
set(root ${CPACK_TEMPORARY_DIRECTORY})
file(GLOB_RECURSE settings RELATIVE ${root} ${root}/etc/*)
list(SORT settings)
list(TRANSFORM settings PREPEND /)
list(JOIN settings "\n" settings)
file(WRITE ${CPACK_SWEEPD_CONFFILES} "${settings}\n")
file(CHMOD_RECURSE ${root} DIRECTORY_PERMISSIONS
     OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(
    COMMAND find ${root} -exec touch --no-dereference -d @$ENV{SOURCE_DATE_EPOCH} {} +
    COMMAND_ERROR_IS_FATAL ANY)
endif()
