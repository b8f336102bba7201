# A consumer project for the sampler alone, and one for the largest library of this build.
function(lmb_consumer_test component)
    add_test(NAME consumer_${component} COMMAND ${CMAKE_COMMAND}
        -D COMPONENT=${component} -D BUILD_DIR=${PROJECT_BINARY_DIR}
        -D WORK_DIR=${CMAKE_CURRENT_BINARY_DIR}/consumer_${component} -D CONFIG=$<CONFIG>
        -D C_COMPILER=${CMAKE_C_COMPILER} -D CXX_COMPILER=${CMAKE_CXX_COMPILER} -D SANITIZE=${LMB_SANITIZE}
        -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer.cmake)
endfunction()

lmb_consumer_test(sampler)
if(TARGET lambent_bake)
    lmb_consumer_test(bake)
elseif(TARGET lambent_volume)
    lmb_consumer_test(volume)
endif()
