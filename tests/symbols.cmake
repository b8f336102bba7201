# Every symbol that a library defines for others begins with lmb_, or is in a C++ namespace that does. Weak ones are
# what the headers of C++ libraries put into an object. Run by CTest as
#     cmake -D NM=... -D LIBRARY=... -P symbols.cmake
cmake_minimum_required(VERSION 3.25)

set(which --extern-only)
if(LIBRARY MATCHES "\\.so")
    set(which --dynamic)
endif()
execute_process(COMMAND ${NM} ${which} --defined-only --format=posix ${LIBRARY} OUTPUT_VARIABLE output
    COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" lines "${output}")
set(ours 0)
foreach(line IN LISTS lines)
    if(line MATCHES "^(lmb_|_Z(TI|TS|TV)?NK?[0-9]+lmb_)")
        math(EXPR ours "${ours} + 1")
    elseif(NOT line MATCHES ":$|^[^ ]+ [WwVvu] ") # the name of an archive's member, or weak
        message(SEND_ERROR "${LIBRARY} exports ${line}")
    endif()
endforeach()
if(ours LESS 10)
    message(SEND_ERROR "${LIBRARY} exports ${ours} symbols: that is no library of ours")
endif()
message("${ours} symbols, all lmb_")
