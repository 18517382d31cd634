# Installation: headers, libraries, a CMake package with components and pkg-config files. Each
# target has its own export set, so that whoever asks for the core alone needs neither what gl nor
# what io stand on.
include(CMakePackageConfigHelpers)

set(PVT_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/paravent)
set(PVT_PKGCONFIG_FOLDER ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The .pc files find their prefix from where they lie, so that an installed tree can be moved.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
    set(PVT_PC_PREFIX "${CMAKE_INSTALL_PREFIX}")
    set(PVT_PC_LIBDIR "${CMAKE_INSTALL_FULL_LIBDIR}")
    set(PVT_PC_INCLUDEDIR "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
else()
    file(RELATIVE_PATH PVT_PC_UP "/${PVT_PKGCONFIG_FOLDER}" "/")
    string(REGEX REPLACE "/$" "" PVT_PC_UP "${PVT_PC_UP}")
    set(PVT_PC_PREFIX "\${pcfiledir}/${PVT_PC_UP}")
    set(PVT_PC_LIBDIR "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
    set(PVT_PC_INCLUDEDIR "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()

# pvt_install_library(gl PC paravent-gl DESCRIPTION "..." REQUIRES paravent PRIVATE_LIBS -ldl)
function(pvt_install_library NAME)
    cmake_parse_arguments(PVT_PC "" "PC;DESCRIPTION" "HEADERS;REQUIRES;PRIVATE_REQUIRES;PRIVATE_LIBS"
                          ${ARGN})
    install(TARGETS paravent_${NAME} EXPORT paravent-${NAME}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    install(EXPORT paravent-${NAME} NAMESPACE paravent:: FILE paravent-${NAME}-targets.cmake
        DESTINATION ${PVT_PACKAGE_FOLDER})
    list(TRANSFORM PVT_PC_HEADERS PREPEND "${PROJECT_SOURCE_DIR}/lib/include/paravent/")
    install(FILES ${PVT_PC_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/paravent)

    list(JOIN PVT_PC_REQUIRES " " PVT_PC_REQUIRES)
    list(JOIN PVT_PC_PRIVATE_REQUIRES " " PVT_PC_PRIVATE_REQUIRES)
    list(JOIN PVT_PC_PRIVATE_LIBS " " PVT_PC_PRIVATE_LIBS)
    set(PVT_PC_LIBRARY paravent_${NAME})
    configure_file(${PROJECT_SOURCE_DIR}/cmake/paravent.pc.in
                   ${PROJECT_BINARY_DIR}/pkgconfig/${PVT_PC_PC}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/pkgconfig/${PVT_PC_PC}.pc
        DESTINATION ${PVT_PKGCONFIG_FOLDER})
endfunction()

pvt_install_library(core PC paravent
    DESCRIPTION "${PROJECT_DESCRIPTION}"
    HEADERS base.h evaluate.h image.h ladder.h mesh.h occluder.h occlusion.h output.h paravent.h
            section.h separate.h voxel.h
    PRIVATE_LIBS -lm -pthread)
if(PARAVENT_GL)
    pvt_install_library(gl PC paravent-gl
        DESCRIPTION "Slices and pictures for paravent by OpenGL, opened at run time"
        HEADERS gl.h
        REQUIRES "paravent = ${PROJECT_VERSION}"
        PRIVATE_LIBS -ldl -lm)
endif()
if(PARAVENT_IO)
    # What the static library leaves to be linked. Only assimp has a .pc file of its own.
    get_target_property(PVT_IO_LINKS paravent_io LINK_LIBRARIES)
    set(PVT_IO_PACKAGES)
    foreach(PVT_PACKAGE IN ITEMS assimp meshoptimizer)
        if(PVT_IO_LINKS MATCHES "${PVT_PACKAGE}")
            list(APPEND PVT_IO_PACKAGES ${PVT_PACKAGE})
        endif()
    endforeach()
    set(PVT_IO_REQUIRES ${PVT_IO_PACKAGES})
    list(FILTER PVT_IO_REQUIRES INCLUDE REGEX "^assimp$")
    set(PVT_IO_LIBS ${PVT_IO_PACKAGES})
    list(FILTER PVT_IO_LIBS EXCLUDE REGEX "^assimp$")
    list(TRANSFORM PVT_IO_LIBS PREPEND "-l")
    pvt_install_library(io PC paravent-io
        DESCRIPTION "Models and images for paravent"
        HEADERS io.h
        REQUIRES "paravent = ${PROJECT_VERSION}"
        PRIVATE_REQUIRES ${PVT_IO_REQUIRES}
        PRIVATE_LIBS ${PVT_IO_LIBS} -lstdc++ -ldl -lm)
endif()

get_target_property(PVT_LIBRARY_TYPE paravent_core TYPE)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/paravent-config.cmake.in
    ${PROJECT_BINARY_DIR}/paravent-config.cmake
    INSTALL_DESTINATION ${PVT_PACKAGE_FOLDER}
    NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/paravent-config-version.cmake
    VERSION ${PROJECT_VERSION}
    COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/paravent-config.cmake
              ${PROJECT_BINARY_DIR}/paravent-config-version.cmake
    DESTINATION ${PVT_PACKAGE_FOLDER})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
