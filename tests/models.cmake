# No lighting model is known outside of its row: cmake -DSOURCE=<project> -P models.cmake
#
# Only bake/model/ may call what the sampler has for one model, or know a row or its name; everything else goes through
# the table.
cmake_minimum_required(VERSION 3.25)
file(GLOB_RECURSE files ${SOURCE}/bake/*.c ${SOURCE}/bake/*.h ${SOURCE}/tools/*.c ${SOURCE}/tools/*.h)
file(GLOB rows ${SOURCE}/bake/model/*.c)
set(known "lmb_(hlsh|hhd|irradz|rnm)|LMB_IRRADZ")

# The rows, and those of their names that could mean nothing else.
file(STRINGS ${SOURCE}/bake/model/models.h lines REGEX "^extern const lmb_model ")
foreach(line IN LISTS lines)
    string(REGEX MATCH "lmb_model_[a-z0-9_]+" row ${line})
    string(APPEND known "|${row}[^a-z0-9_]")
endforeach()
foreach(file IN LISTS rows)
    file(STRINGS ${file} lines REGEX "^    \\.(name|full_name) = \"[a-z0-9]+[.-]")
    foreach(line IN LISTS lines)
        string(REGEX MATCH "\"[^\"]+\"" name ${line})
        string(REPLACE "." "[.]" name ${name})
        string(APPEND known "|${name}")
    endforeach()
endforeach()

set(faults 0)
foreach(file IN LISTS files)
    if(file MATCHES "/bake/(model|bump)/|/tools/bump_") # bump maps are of one model
        continue()
    endif()
    file(STRINGS ${file} lines REGEX "${known}")
    foreach(line IN LISTS lines)
        message("${file}: ${line}")
        math(EXPR faults "${faults} + 1")
    endforeach()
endforeach()
if(faults GREATER 0)
    message(FATAL_ERROR "${faults} faults")
endif()
