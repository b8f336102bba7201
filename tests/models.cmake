# No lighting model is known outside of its row: cmake -DSOURCE=<project> -P models.cmake
#
# Only bake/model/ may call what the sampler has for one model; everything else goes through the table.
cmake_minimum_required(VERSION 3.25)
file(GLOB_RECURSE files ${SOURCE}/bake/*.c ${SOURCE}/bake/*.h ${SOURCE}/tools/*.c ${SOURCE}/tools/*.h)
set(faults 0)
foreach(file IN LISTS files)
    if(file MATCHES "/bake/model/")
        continue()
    endif()
    file(STRINGS ${file} lines REGEX "lmb_(hlsh|hhd|irradz|model_(hlsh|irradz|sh3))|LMB_IRRADZ")
    foreach(line IN LISTS lines)
        message("${file}: ${line}")
        math(EXPR faults "${faults} + 1")
    endforeach()
endforeach()
if(faults GREATER 0)
    message(FATAL_ERROR "${faults} faults")
endif()
