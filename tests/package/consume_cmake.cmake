# Configures, builds and runs a project that uses the library. With REFUSED, configuring must fail
# and say why.
file(REMOVE_RECURSE ${BUILD})
string(REPLACE "," ";" COMPONENTS "${COMPONENTS}")
execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G ${GENERATOR}
            -DCMAKE_BUILD_TYPE=Debug -DCMAKE_${LANGUAGE}_COMPILER=${COMPILER}
            -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
            -DLANGUAGE=${LANGUAGE} "-DCOMPONENTS=${COMPONENTS}" -DVERSION=${VERSION}
            -DPARAVENT=${PARAVENT} -DCONSUMER=${CONSUMER} -Wno-dev
    OUTPUT_VARIABLE TEXT ERROR_VARIABLE TEXT RESULT_VARIABLE FAILED)
if(REFUSED)
    if(NOT FAILED OR NOT TEXT MATCHES "no component teapot|version: \"?99.0\"?|version \"99.0\"")
        message(FATAL_ERROR "this should have been refused:\n${TEXT}")
    endif()
    return()
elseif(FAILED)
    message(FATAL_ERROR "cannot configure:\n${TEXT}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} COMMAND_ERROR_IS_FATAL ANY)
file(GLOB PROGRAMS ${BUILD}/use_*)
list(FILTER PROGRAMS EXCLUDE REGEX "\\.[a-z]+$")
if(NOT PROGRAMS)
    message(FATAL_ERROR "nothing was built")
endif()
foreach(PROGRAM IN LISTS PROGRAMS)
    execute_process(COMMAND ${PROGRAM} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
