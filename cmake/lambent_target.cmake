# What every target of the house shares: language level, warnings, sanitizers and reproducible arithmetic.

# Bytes must repeat: no fused multiply-add that the source does not ask for, nothing "fast".
if(MSVC)
    set(LMB_ARITHMETIC /fp:precise)
    set(LMB_C_WARNINGS /W4)
    set(LMB_CXX_WARNINGS /W4)
    set(LMB_WARNINGS_ARE_ERRORS /WX)
else()
    set(LMB_ARITHMETIC -ffp-contract=off)
    set(LMB_C_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wundef -Wstrict-prototypes -Wmissing-prototypes)
    if(CMAKE_C_COMPILER_ID STREQUAL "GNU") # clang warns of every isfinite() of a float
        list(APPEND LMB_C_WARNINGS -Wdouble-promotion)
    endif()
    set(LMB_CXX_WARNINGS -Wall -Wextra -Wshadow -Wundef)
    set(LMB_WARNINGS_ARE_ERRORS -Werror)
endif()

function(lmb_target_defaults target)
    target_compile_features(${target} PRIVATE c_std_11)
    set_target_properties(${target} PROPERTIES C_EXTENSIONS OFF CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE
        ${LMB_ARITHMETIC}
        $<$<COMPILE_LANGUAGE:C>:${LMB_C_WARNINGS}>
        $<$<COMPILE_LANGUAGE:CXX>:${LMB_CXX_WARNINGS}>
        $<$<BOOL:${LMB_WARNINGS_AS_ERRORS}>:${LMB_WARNINGS_ARE_ERRORS}>)
    if(LMB_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${LMB_SANITIZE} -fno-omit-frame-pointer)
        if(LMB_SANITIZE MATCHES "undefined") # else it is said, and the test passes
            target_compile_options(${target} PRIVATE -fno-sanitize-recover=undefined)
            if(CMAKE_C_COMPILER_ID MATCHES "Clang") # it finds a misaligned base in TBB's concurrent_hash_map.h
                target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=alignment>)
            endif()
        endif()
        target_link_options(${target} PUBLIC -fsanitize=${LMB_SANITIZE})
    endif()
endfunction()

# A static library of the house, `lambent_<name>` with alias `lambent::<name>`; with SHARED a shared one. Its public
# headers are in include/lambent; only targets that link it see them, so an include against the one-way order does not
# compile.
function(lmb_library name)
    cmake_parse_arguments(arg "SHARED" "" "SOURCES;PUBLIC_LINKS;PRIVATE_LINKS" ${ARGN})
    set(target lambent_${name})
    set(kind STATIC)
    if(arg_SHARED)
        set(kind SHARED)
    endif()
    add_library(${target} ${kind} ${arg_SOURCES})
    add_library(lambent::${name} ALIAS ${target})
    lmb_target_defaults(${target})
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endfunction()
