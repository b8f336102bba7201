# The table of specular lobes is the one that the program makes: cmake -DWRITER=... -DFILE=... -DOUTPUT=... -P this
execute_process(COMMAND ${WRITER} ${OUTPUT} RESULT_VARIABLE wrote)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${OUTPUT} ${FILE} RESULT_VARIABLE differ)
if(wrote OR differ)
    message(FATAL_ERROR "${FILE} is not what lambent_specular_tables writes: write it again")
endif()
