# What every target of the house shares: language level, warnings, sanitizers and reproducible arithmetic.

set(LMB_C_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wundef -Wdouble-promotion -Wstrict-prototypes
    -Wmissing-prototypes)
set(LMB_CXX_WARNINGS -Wall -Wextra -Wshadow -Wundef)

function(lmb_target_defaults target)
    target_compile_features(${target} PRIVATE c_std_11)
    set_target_properties(${target} PROPERTIES C_EXTENSIONS OFF CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    # Bytes must repeat: no fused multiply-add that the source does not ask for.
    target_compile_options(${target} PRIVATE
        -ffp-contract=off
        $<$<COMPILE_LANGUAGE:C>:${LMB_C_WARNINGS}>
        $<$<COMPILE_LANGUAGE:CXX>:${LMB_CXX_WARNINGS}>
        $<$<BOOL:${LMB_WARNINGS_AS_ERRORS}>:-Werror>)
    if(LMB_SANITIZE)
        target_compile_options(${target} PRIVATE -fsanitize=${LMB_SANITIZE} -fno-omit-frame-pointer)
        target_link_options(${target} PUBLIC -fsanitize=${LMB_SANITIZE})
    endif()
endfunction()

# A library of the house, `lambent_<name>` with alias `lambent::<name>`. Its public headers are in
# include/lambent; only targets that link it see them, so an include against the one-way order does not compile.
function(lmb_library name)
    cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC_LINKS;PRIVATE_LINKS" ${ARGN})
    set(target lambent_${name})
    add_library(${target} STATIC ${arg_SOURCES})
    add_library(lambent::${name} ALIAS ${target})
    lmb_target_defaults(${target})
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endfunction()
