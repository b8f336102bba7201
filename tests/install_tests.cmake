# Consumer projects: for the sampler alone, static and shared, and for the largest library of this build.
function(lmb_consumer_test name component)
    add_test(NAME consumer_${name} COMMAND ${CMAKE_COMMAND}
        -D COMPONENT=${component} -D BUILD_DIR=${PROJECT_BINARY_DIR}
        -D WORK_DIR=${CMAKE_CURRENT_BINARY_DIR}/consumer_${name} -D CONFIG=$<CONFIG>
        -D C_COMPILER=${CMAKE_C_COMPILER} -D CXX_COMPILER=${CMAKE_CXX_COMPILER} -D SANITIZE=${LMB_SANITIZE}
        ${ARGN} -P ${CMAKE_CURRENT_SOURCE_DIR}/consumer.cmake)
endfunction()

lmb_consumer_test(sampler sampler)
lmb_consumer_test(shared_sampler sampler -D SHARED_FROM=${PROJECT_SOURCE_DIR} -D NM=${CMAKE_NM})
if(TARGET lambent_bake)
    lmb_consumer_test(bake bake)
elseif(TARGET lambent_volume)
    lmb_consumer_test(volume volume)
endif()

# Sanitizers add symbols of their own.
if(NOT LMB_SANITIZE)
    foreach(library sampler volume bake)
        if(TARGET lambent_${library})
            add_test(NAME symbols_${library} COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM}
                -D LIBRARY=$<TARGET_FILE:lambent_${library}> -P ${CMAKE_CURRENT_SOURCE_DIR}/symbols.cmake)
        endif()
    endforeach()
endif()
