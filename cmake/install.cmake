# What `cmake --install` puts where. `--component sampler` installs the sampler alone, which needs neither C++ nor any
# library; without it everything that this build has is installed.
include(CMakePackageConfigHelpers)

set(LMB_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/lambent)

# lmb_install_library(name component targets...): the library lambent_<name>, the helper targets that it exports
# beside it, and its public headers.
function(lmb_install_library name component)
    install(TARGETS lambent_${name} ${ARGN} EXPORT lambent-${name}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${name}/include/lambent DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT ${component} FILES_MATCHING PATTERN "*.h")
    install(EXPORT lambent-${name} FILE lambent-${name}-targets.cmake NAMESPACE lambent::
        DESTINATION ${LMB_PACKAGE_DIR} COMPONENT ${component})
endfunction()

lmb_install_library(sampler sampler)
if(TARGET lambent_volume)
    lmb_install_library(volume tools lambent_openvdb)
endif()
if(TARGET lambent_bake)
    lmb_install_library(bake tools)
endif()
if(TARGET lambent)
    install(TARGETS lambent RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
endif()

# One package for all: which of the libraries it offers depends on what lies beside it.
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/lambent-config.cmake.in
    ${PROJECT_BINARY_DIR}/lambent-config.cmake INSTALL_DESTINATION ${LMB_PACKAGE_DIR}
    NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lambent-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lambent-config.cmake ${PROJECT_BINARY_DIR}/lambent-config-version.cmake
    DESTINATION ${LMB_PACKAGE_DIR} COMPONENT sampler)

# Relative to the .pc file itself, so that the installed tree may be moved.
set(pc_dir ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH LMB_PC_PREFIX ${pc_dir} ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH LMB_PC_LIBDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH LMB_PC_INCLUDEDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(LMB_PC_CFLAGS "")
if(BUILD_SHARED_LIBS)
    set(LMB_PC_CFLAGS " -DLMB_SHARED")
endif()
set(LMB_PC_LIBS "")
if(NOT WIN32)
    set(LMB_PC_LIBS " -lm")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/lambent_sampler.pc.in ${PROJECT_BINARY_DIR}/lambent_sampler.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lambent_sampler.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT sampler)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/sampler/shader DESTINATION ${CMAKE_INSTALL_DATADIR}/lambent
    COMPONENT sampler)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sampler)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools
    FILES_MATCHING PATTERN "*.md")
