# Compiles, links and runs the consumers with what pkg-config says, as a makefile would.
file(REMOVE_RECURSE ${BUILD})
file(MAKE_DIRECTORY ${BUILD})
string(REPLACE "," ";" COMPONENTS "${COMPONENTS}")
set(SUFFIX_C c)
set(SUFFIX_CXX cpp)
set(STANDARD_C -std=c17)
set(STANDARD_CXX -std=c++17)
foreach(COMPONENT IN LISTS COMPONENTS)
    set(PACKAGE paravent-${COMPONENT})
    if(COMPONENT STREQUAL "core")
        set(PACKAGE paravent)
    endif()
    set(STATIC --static)
    if(SHARED)
        set(STATIC)
    endif()
    execute_process(COMMAND ${PKG_CONFIG} ${STATIC} --cflags --libs ${PACKAGE}
        OUTPUT_VARIABLE FLAGS OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(FLAGS UNIX_COMMAND "${FLAGS}")
    set(PROGRAM ${BUILD}/use_${COMPONENT})
    execute_process(
        COMMAND ${COMPILER} ${STANDARD_${LANGUAGE}} -Wall -Wextra -Werror
                ${SOURCE}/use_${COMPONENT}.${SUFFIX_${LANGUAGE}} -o ${PROGRAM} ${FLAGS}
        COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${LIBDIR} ${PROGRAM}
        COMMAND_ERROR_IS_FATAL ANY)
endforeach()
