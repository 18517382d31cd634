# What every target of the project shares: language, warnings, determinism, sanitizers.
add_library(pvt_flags INTERFACE)
target_compile_options(pvt_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    -ffp-contract=off
    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
    $<$<BOOL:${PARAVENT_WERROR}>:-Werror>)
# gcc 12 takes (double)(float)x for x wherever it packs two of them into a vector, so that what
# should have been rounded as files store it is not.
foreach(PVT_LANGUAGE IN ITEMS C CXX)
    if(CMAKE_${PVT_LANGUAGE}_COMPILER_ID STREQUAL "GNU" AND
       CMAKE_${PVT_LANGUAGE}_COMPILER_VERSION VERSION_GREATER_EQUAL 12 AND
       CMAKE_${PVT_LANGUAGE}_COMPILER_VERSION VERSION_LESS 13)
        target_compile_options(pvt_flags INTERFACE
            $<$<COMPILE_LANGUAGE:${PVT_LANGUAGE}>:-fno-tree-slp-vectorize>)
    endif()
endforeach()
target_compile_definitions(pvt_flags INTERFACE _GNU_SOURCE)
if(PARAVENT_SANITIZE)
    target_compile_options(pvt_flags INTERFACE
        -fsanitize=${PARAVENT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
    target_link_options(pvt_flags INTERFACE -fsanitize=${PARAVENT_SANITIZE})
endif()

# pvt_add_library(core) makes paravent_core, known as paravent::core here and after installation.
function(pvt_add_library NAME)
    add_library(paravent_${NAME})
    add_library(paravent::${NAME} ALIAS paravent_${NAME})
    set_target_properties(paravent_${NAME} PROPERTIES
        EXPORT_NAME ${NAME}
        C_STANDARD 17 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
        CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
        C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden
        POSITION_INDEPENDENT_CODE ON
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
    target_include_directories(paravent_${NAME}
        PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib/include>
               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
        PRIVATE ${PROJECT_SOURCE_DIR}/lib)
    target_link_libraries(paravent_${NAME} PRIVATE $<BUILD_INTERFACE:pvt_flags>)
    if(BUILD_SHARED_LIBS AND NOT PARAVENT_SANITIZE)
        # What a library needs, it names: nothing is left for the program to bring along.
        target_link_options(paravent_${NAME} PRIVATE LINKER:--no-undefined)
    endif()
endfunction()
