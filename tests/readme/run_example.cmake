# Takes the first C program out of the README, compiles it with warnings as errors, and runs it.
file(READ ${README} TEXT)
string(FIND "${TEXT}" "```c\n" BEGIN)
if(BEGIN LESS 0)
    message(FATAL_ERROR "no C program in ${README}")
endif()
math(EXPR BEGIN "${BEGIN} + 5")
string(SUBSTRING "${TEXT}" ${BEGIN} -1 TEXT)
string(FIND "${TEXT}" "```" END)
string(SUBSTRING "${TEXT}" 0 ${END} TEXT)
file(WRITE ${FOLDER}/example.c "${TEXT}")
execute_process(
    COMMAND ${COMPILER} -std=c17 -Wall -Wextra -Werror -pedantic -I${INCLUDE} ${FOLDER}/example.c
            ${LIBRARY} -lm -pthread -o ${FOLDER}/example
    COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/example OUTPUT_VARIABLE TEXT COMMAND_ERROR_IS_FATAL ANY)
if(NOT TEXT MATCHES "^([1-9]|1[0-2]) triangles\n$")
    message(FATAL_ERROR "the example made no occluder of 1 to 12 triangles, but said: ${TEXT}")
endif()
