# The networks in the shader include are those of the sampler: cmake -DWRITER=... -DFILE=... -DOUTPUT=... -P this
execute_process(COMMAND ${WRITER} ${OUTPUT} RESULT_VARIABLE wrote)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${OUTPUT} ${FILE} RESULT_VARIABLE differ)
if(wrote OR differ)
    message(FATAL_ERROR "${FILE} is not what lambent_multiply_shader writes: write it again")
endif()
