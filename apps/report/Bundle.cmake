# Bundles the page in a copy of its folder, so that the sources stay as they are. A build must not
# fail where npm has no network: then the stand-in is taken, and the command says what is missing.
foreach(FILE IN LISTS FILES)
    configure_file(${FOLDER}/${FILE} ${WORK}/${FILE} COPYONLY)
endforeach()
execute_process(
    COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    WORKING_DIRECTORY ${WORK} RESULT_VARIABLE FAILED)
if(NOT FAILED)
    execute_process(COMMAND ${NODE} bundle.mjs ${OUTPUT} WORKING_DIRECTORY ${WORK}
                    RESULT_VARIABLE FAILED)
endif()
if(FAILED)
    message(WARNING "evaluate --report is left out: npm or esbuild failed (see above)")
    configure_file(${STAND_IN} ${OUTPUT} COPYONLY)
endif()
