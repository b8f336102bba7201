# The shader include (sampler/shader/) is compiled as GLSL and as HLSL, and run against the sampler.
find_program(LMB_GLSLANG glslangValidator)
find_package(Vulkan QUIET)
if(NOT LMB_GLSLANG OR NOT Vulkan_FOUND)
    message(STATUS "No shader tests: glslangValidator or Vulkan is missing (Debian: glslang-tools, libvulkan-dev)")
    return()
endif()

set(shader_sources ${PROJECT_SOURCE_DIR}/sampler/shader/lambent.glsl ${PROJECT_SOURCE_DIR}/sampler/shader/lambent.hlsl
    ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_networks.glsl ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_probe.glsl
    ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_specular.glsl
    ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_rnm.glsl
    ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_sampling.glsl ${CMAKE_CURRENT_SOURCE_DIR}/shaders/cases.glsl
    ${PROJECT_SOURCE_DIR}/sampler/shader/lambent_volume_texture.glsl
    ${CMAKE_CURRENT_SOURCE_DIR}/shaders/volume_buffers.glsl ${CMAKE_CURRENT_SOURCE_DIR}/shaders/volume_item.glsl
    ${CMAKE_CURRENT_SOURCE_DIR}/shaders/volume_cases.glsl ${CMAKE_CURRENT_SOURCE_DIR}/shaders/volume_texture_cases.glsl)
# lmb_shader(output source options...): SPIR-V of a source in tests/shaders/.
function(lmb_shader output source)
    add_custom_command(OUTPUT ${output}
        COMMAND ${LMB_GLSLANG} --quiet -V ${ARGN} -I${PROJECT_SOURCE_DIR}/sampler/shader -I${CMAKE_CURRENT_SOURCE_DIR}/shaders
            ${CMAKE_CURRENT_SOURCE_DIR}/shaders/${source} -o ${output}
        DEPENDS ${shader_sources} ${CMAKE_CURRENT_SOURCE_DIR}/shaders/${source} VERBATIM)
endfunction()
set(glsl ${CMAKE_CURRENT_BINARY_DIR}/shader_glsl.spv)
set(hlsl ${CMAKE_CURRENT_BINARY_DIR}/shader_hlsl.spv)
lmb_shader(${glsl} run.comp)
lmb_shader(${hlsl} run.hlsl -D -S comp -e main)
set(texture ${CMAKE_CURRENT_BINARY_DIR}/shader_texture.spv)
lmb_shader(${texture} texture.comp)
set(volume_glsl ${CMAKE_CURRENT_BINARY_DIR}/shader_volume_glsl.spv)
set(volume_hlsl ${CMAKE_CURRENT_BINARY_DIR}/shader_volume_hlsl.spv)
lmb_shader(${volume_glsl} volume.comp)
lmb_shader(${volume_hlsl} volume.hlsl -D -S comp -e main)
# Volumes in textures, filtered by the sampler and by hand.
set(volume_textures)
foreach(way FILTER FETCH)
    set(in_glsl ${CMAKE_CURRENT_BINARY_DIR}/shader_volume_texture_${way}_glsl.spv)
    set(in_hlsl ${CMAKE_CURRENT_BINARY_DIR}/shader_volume_texture_${way}_hlsl.spv)
    lmb_shader(${in_glsl} volume_texture.comp -DLMB_VOLUME_TEXTURE_${way})
    lmb_shader(${in_hlsl} volume_texture.hlsl -D -S comp -e main -DLMB_VOLUME_TEXTURE_${way})
    list(APPEND volume_textures ${in_glsl} ${in_hlsl})
    list(APPEND volume_texture_names LMB_SHADER_${way}_GLSL="${in_glsl}" LMB_SHADER_${way}_HLSL="${in_hlsl}")
endforeach()
add_custom_target(lambent_test_shaders DEPENDS ${glsl} ${hlsl} ${texture} ${volume_glsl} ${volume_hlsl}
    ${volume_textures})

lmb_test(shader LINKS lambent::sampler Vulkan::Vulkan m)
target_sources(test_shader PRIVATE shader_runner.c)
target_compile_definitions(test_shader PRIVATE LMB_SHADER_GLSL="${glsl}" LMB_SHADER_HLSL="${hlsl}")
add_dependencies(test_shader lambent_test_shaders)
# Mesa's driver keeps what it allocates until the process ends, after it was unloaded.
set_tests_properties(shader PROPERTIES ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0")

if(NOT LMB_SAMPLER_ONLY)
    lmb_test(texture_sampler LINKS lambent::bake Vulkan::Vulkan m)
    target_sources(test_texture_sampler PRIVATE shader_runner.c)
    target_compile_definitions(test_texture_sampler PRIVATE LMB_SHADER_TEXTURE="${texture}")
    target_include_directories(test_texture_sampler PRIVATE ${PROJECT_SOURCE_DIR}/bake)
    add_dependencies(test_texture_sampler lambent_test_shaders)
    set_tests_properties(texture_sampler PROPERTIES ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0")
    lmb_test(shader_volume LINKS lambent::volume Vulkan::Vulkan m)
    target_sources(test_shader_volume PRIVATE shader_runner.c)
    target_compile_definitions(test_shader_volume PRIVATE LMB_SHADER_GLSL="${volume_glsl}"
        LMB_SHADER_HLSL="${volume_hlsl}")
    add_dependencies(test_shader_volume lambent_test_shaders)
    set_tests_properties(shader_volume PROPERTIES ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0")
    lmb_test(shader_texture LINKS lambent::volume Vulkan::Vulkan m)
    target_sources(test_shader_texture PRIVATE shader_runner.c)
    target_compile_definitions(test_shader_texture PRIVATE ${volume_texture_names})
    add_dependencies(test_shader_texture lambent_test_shaders)
    set_tests_properties(shader_texture PROPERTIES ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0")
endif()
