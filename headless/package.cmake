# Installation: programs, scenes, man pages, completion. `cpack -G DEB` makes a package of them and of the libraries of capture/.
include(GNUInstallDirs)
install(TARGETS collidoscope collidoscope-headless RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
set(share ${CMAKE_INSTALL_DATADIR}/collidoscope)
install(DIRECTORY assets/fonts assets/scenes assets/shaders DESTINATION ${share}/assets)
install(FILES assets/tuned.json DESTINATION ${share}/assets)
install(DIRECTORY sim_cuda/plugin/examples capture/example DESTINATION ${share})
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The program writes its man pages and completion from the tables of commands and flags.
set(pages "")
foreach(page "collidoscope.1 --man collidoscope" "collidoscope-headless.1 --man collidoscope-headless" "collidoscope.bash --completion")
  separate_arguments(page)
  list(POP_FRONT page file)
  add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/pages/${file} DEPENDS collidoscope-headless VERBATIM
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/pages
    COMMAND collidoscope-headless help ${page} > ${PROJECT_BINARY_DIR}/pages/${file})
  list(APPEND pages ${PROJECT_BINARY_DIR}/pages/${file})
endforeach()
if(NOT COLLIDOSCOPE_SANITIZE)
  add_custom_target(pages ALL DEPENDS ${pages})
endif()
install(FILES ${PROJECT_BINARY_DIR}/pages/collidoscope.1 ${PROJECT_BINARY_DIR}/pages/collidoscope-headless.1
  DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
install(FILES ${PROJECT_BINARY_DIR}/pages/collidoscope.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME collidoscope OPTIONAL)
install(FILES ${PROJECT_BINARY_DIR}/pages/collidoscope.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME collidoscope-headless OPTIONAL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Visual debugger and profiler for GPU broad phases and rigid-body simulation")
set(CPACK_PACKAGE_CONTACT "the authors of Collidoscope")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libgl1")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libgtest-dev, libpng-dev, ffmpeg")
include(CPack)
