#include "shader_runner.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vulkan/vulkan.h>

enum { INPUT, OUTPUT, TEXELS, BUFFERS, BOUND = TEXELS };

/* Everything that is made, in this order; what is not stays 0, which Vulkan destroys without a word. */
typedef struct runner {
    const shader_texture *texture; /* NULL: none */
    VkInstance instance;
    VkPhysicalDevice physical;
    uint32_t family; /* of queues, one that computes */
    VkDevice device;
    VkBuffer buffer[BUFFERS];
    VkDeviceMemory memory[BUFFERS];
    VkDeviceSize size[BUFFERS];
    VkImage image;
    VkDeviceMemory image_memory;
    VkImageView view;
    VkSampler sampler;
    VkShaderModule module;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout pipeline_layout;
    VkPipeline pipeline;
    VkDescriptorPool descriptors;
    VkDescriptorSet set;
    VkCommandPool commands;
} runner;

static bool instance_make(runner *r)
{
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pApplicationInfo = &application};
    return vkCreateInstance(&info, NULL, &r->instance) == VK_SUCCESS;
}

/* Whether a device can sample the texture. */
static bool format_is_known(const runner *r, VkPhysicalDevice device)
{
    if (!r->texture) {
        return true;
    }
    VkFormatProperties properties;
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(device, &features);
    vkGetPhysicalDeviceFormatProperties(device, (VkFormat)r->texture->format, &properties);
    return (features.textureCompressionBC || r->texture->depth > 0) &&
           (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT);
}

/* The first device with a queue that computes. */
static bool device_find(runner *r)
{
    VkPhysicalDevice devices[8];
    uint32_t count = 8;
    const VkResult found = vkEnumeratePhysicalDevices(r->instance, &count, devices);
    for (uint32_t i = 0; i < count && (found == VK_SUCCESS || found == VK_INCOMPLETE); ++i) {
        VkQueueFamilyProperties families[16];
        uint32_t family_count = 16;
        vkGetPhysicalDeviceQueueFamilyProperties(devices[i], &family_count, families);
        for (uint32_t k = 0; k < family_count; ++k) {
            if ((families[k].queueFlags & VK_QUEUE_COMPUTE_BIT) && format_is_known(r, devices[i])) {
                r->physical = devices[i];
                r->family = k;
                return true;
            }
        }
    }
    return false;
}

static bool device_make(runner *r)
{
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = r->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkPhysicalDeviceFeatures features = {.textureCompressionBC = r->texture && r->texture->depth == 0};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .pEnabledFeatures = &features};
    return vkCreateDevice(r->physical, &info, NULL, &r->device) == VK_SUCCESS;
}

/* Memory that the processor sees too. */
static bool memory_type_find(const runner *r, uint32_t allowed, uint32_t *type)
{
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(r->physical, &memory);
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((allowed >> i & 1) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
            *type = i;
            return true;
        }
    }
    return false;
}

static bool buffer_make(runner *r, int which, size_t bytes)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = bytes,
                                     .usage = which == TEXELS ? VK_BUFFER_USAGE_TRANSFER_SRC_BIT
                                                              : VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    if (vkCreateBuffer(r->device, &info, NULL, &r->buffer[which]) != VK_SUCCESS) {
        return false;
    }
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(r->device, r->buffer[which], &needs);
    VkMemoryAllocateInfo memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    r->size[which] = bytes;
    return memory_type_find(r, needs.memoryTypeBits, &memory.memoryTypeIndex) &&
           vkAllocateMemory(r->device, &memory, NULL, &r->memory[which]) == VK_SUCCESS &&
           vkBindBufferMemory(r->device, r->buffer[which], r->memory[which], 0) == VK_SUCCESS;
}

static bool buffer_write(const runner *r, int which, const void *from)
{
    void *mapped;
    if (vkMapMemory(r->device, r->memory[which], 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
        return false;
    }
    memcpy(mapped, from, r->size[which]);
    vkUnmapMemory(r->device, r->memory[which]);
    return true;
}

static bool buffer_read(const runner *r, int which, float *to)
{
    void *mapped;
    if (vkMapMemory(r->device, r->memory[which], 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
        return false;
    }
    memcpy(to, mapped, r->size[which]);
    vkUnmapMemory(r->device, r->memory[which]);
    return true;
}

static bool image_make(runner *r)
{
    const shader_texture *texture = r->texture;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = texture->depth > 0 ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D,
        .format = (VkFormat)texture->format,
        .extent = {texture->width, texture->height, texture->depth > 0 ? texture->depth : 1},
        .mipLevels = texture->levels,
        .arrayLayers = texture->layers,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    if (vkCreateImage(r->device, &info, NULL, &r->image) != VK_SUCCESS) {
        return false;
    }
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(r->device, r->image, &needs);
    VkMemoryAllocateInfo memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    return memory_type_find(r, needs.memoryTypeBits, &memory.memoryTypeIndex) &&
           vkAllocateMemory(r->device, &memory, NULL, &r->image_memory) == VK_SUCCESS &&
           vkBindImageMemory(r->device, r->image, r->image_memory, 0) == VK_SUCCESS;
}

static VkImageSubresourceRange whole_image(const runner *r)
{
    return (VkImageSubresourceRange){VK_IMAGE_ASPECT_COLOR_BIT, 0, r->texture->levels, 0, r->texture->layers};
}

/* Filtered linearly within a level, clamped at the borders. */
static bool sampler_make(runner *r)
{
    const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                        .image = r->image,
                                        .viewType =
                                            r->texture->depth > 0 ? VK_IMAGE_VIEW_TYPE_3D : VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                        .format = (VkFormat)r->texture->format,
                                        .subresourceRange = whole_image(r)};
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                         .magFilter = VK_FILTER_LINEAR,
                                         .minFilter = VK_FILTER_LINEAR,
                                         .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                         .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                         .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                         .maxLod = VK_LOD_CLAMP_NONE};
    return vkCreateImageView(r->device, &view, NULL, &r->view) == VK_SUCCESS &&
           vkCreateSampler(r->device, &sampler, NULL, &r->sampler) == VK_SUCCESS;
}

static bool texture_make(runner *r)
{
    return !r->texture || (buffer_make(r, TEXELS, r->texture->size) && buffer_write(r, TEXELS, r->texture->data) &&
                           image_make(r) && sampler_make(r));
}

static void image_turn(const runner *r, VkCommandBuffer command, VkImageLayout from, VkImageLayout to)
{
    const VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                          .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                          .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                          .oldLayout = from,
                                          .newLayout = to,
                                          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .image = r->image,
                                          .subresourceRange = whole_image(r)};
    vkCmdPipelineBarrier(command, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
                         NULL, 1, &barrier);
}

static uint32_t halved(uint32_t side, uint32_t level)
{
    return side >> level > 0 ? side >> level : 1;
}

static void texture_copy(const runner *r, VkCommandBuffer command)
{
    const shader_texture *texture = r->texture;
    image_turn(r, command, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    for (uint32_t level = 0; level < texture->levels; ++level) {
        const VkBufferImageCopy copy = {.bufferOffset = texture->level_start[level],
                                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, texture->layers},
                                        .imageExtent = {halved(texture->width, level), halved(texture->height, level),
                                                        texture->depth > 0 ? texture->depth : 1}};
        vkCmdCopyBufferToImage(command, r->buffer[TEXELS], r->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    }
    image_turn(r, command, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

static bool module_make(runner *r, const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return false;
    }
    enum { MOST_WORDS = 1 << 18 };
    uint32_t *words = malloc(MOST_WORDS * sizeof *words);
    const size_t count = words ? fread(words, sizeof *words, MOST_WORDS, file) : 0;
    fclose(file);
    const VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = count * sizeof *words, .pCode = words};
    const bool made = count > 0 && vkCreateShaderModule(r->device, &info, NULL, &r->module) == VK_SUCCESS;
    free(words);
    return made;
}

static bool layouts_make(runner *r)
{
    VkDescriptorSetLayoutBinding bindings[BOUND + 1];
    for (uint32_t i = 0; i < BOUND; ++i) {
        bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
                                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                     .descriptorCount = 1,
                                                     .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    bindings[BOUND] = (VkDescriptorSetLayoutBinding){.binding = BOUND,
                                                     .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                                     .descriptorCount = 1,
                                                     .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                 .bindingCount = BOUND + (r->texture != NULL),
                                                 .pBindings = bindings};
    if (vkCreateDescriptorSetLayout(r->device, &set, NULL, &r->set_layout) != VK_SUCCESS) {
        return false;
    }
    const VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 1, .pSetLayouts = &r->set_layout};
    return vkCreatePipelineLayout(r->device, &layout, NULL, &r->pipeline_layout) == VK_SUCCESS;
}

static bool pipeline_make(runner *r)
{
    const VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = r->module,
                  .pName = "main"},
        .layout = r->pipeline_layout,
    };
    return vkCreateComputePipelines(r->device, VK_NULL_HANDLE, 1, &info, NULL, &r->pipeline) == VK_SUCCESS;
}

static bool set_make(runner *r)
{
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BOUND},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1}};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 2, .pPoolSizes = sizes};
    if (vkCreateDescriptorPool(r->device, &pool, NULL, &r->descriptors) != VK_SUCCESS) {
        return false;
    }
    const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = r->descriptors,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &r->set_layout};
    if (vkAllocateDescriptorSets(r->device, &info, &r->set) != VK_SUCCESS) {
        return false;
    }
    for (uint32_t i = 0; i < BOUND; ++i) {
        const VkDescriptorBufferInfo buffer = {r->buffer[i], 0, VK_WHOLE_SIZE};
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = r->set,
                                            .dstBinding = i,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                            .pBufferInfo = &buffer};
        vkUpdateDescriptorSets(r->device, 1, &write, 0, NULL);
    }
    if (r->texture) {
        const VkDescriptorImageInfo image = {r->sampler, r->view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = r->set,
                                            .dstBinding = BOUND,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            .pImageInfo = &image};
        vkUpdateDescriptorSets(r->device, 1, &write, 0, NULL);
    }
    return true;
}

static bool dispatch(runner *r, unsigned groups)
{
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = r->family};
    if (vkCreateCommandPool(r->device, &pool, NULL, &r->commands) != VK_SUCCESS) {
        return false;
    }
    const VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = r->commands,
                                              .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                              .commandBufferCount = 1};
    VkCommandBuffer command;
    if (vkAllocateCommandBuffers(r->device, &info, &command) != VK_SUCCESS) {
        return false;
    }
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vkBeginCommandBuffer(command, &begin);
    if (r->texture) {
        texture_copy(r, command);
    }
    vkCmdBindPipeline(command, VK_PIPELINE_BIND_POINT_COMPUTE, r->pipeline);
    vkCmdBindDescriptorSets(command, VK_PIPELINE_BIND_POINT_COMPUTE, r->pipeline_layout, 0, 1, &r->set, 0, NULL);
    vkCmdDispatch(command, groups, 1, 1);
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &command};
    VkQueue queue;
    vkGetDeviceQueue(r->device, r->family, 0, &queue);
    return vkEndCommandBuffer(command) == VK_SUCCESS &&
           vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE) == VK_SUCCESS && vkQueueWaitIdle(queue) == VK_SUCCESS;
}

static void runner_destroy(runner *r)
{
    if (r->device) {
        vkDestroyCommandPool(r->device, r->commands, NULL);
        vkDestroyDescriptorPool(r->device, r->descriptors, NULL);
        vkDestroyPipeline(r->device, r->pipeline, NULL);
        vkDestroyPipelineLayout(r->device, r->pipeline_layout, NULL);
        vkDestroyDescriptorSetLayout(r->device, r->set_layout, NULL);
        vkDestroyShaderModule(r->device, r->module, NULL);
        vkDestroySampler(r->device, r->sampler, NULL);
        vkDestroyImageView(r->device, r->view, NULL);
        vkDestroyImage(r->device, r->image, NULL);
        vkFreeMemory(r->device, r->image_memory, NULL);
        for (int i = 0; i < BUFFERS; ++i) {
            vkDestroyBuffer(r->device, r->buffer[i], NULL);
            vkFreeMemory(r->device, r->memory[i], NULL);
        }
        vkDestroyDevice(r->device, NULL);
    }
    if (r->instance) {
        vkDestroyInstance(r->instance, NULL);
    }
}

shader_run_result shader_run(const char *path, unsigned groups, const shader_texture *texture,
                             const shader_floats *input, const shader_floats *output)
{
    runner r = {.texture = texture};
    shader_run_result result = SHADER_NO_DEVICE;
    if (instance_make(&r) && device_find(&r) && device_make(&r)) {
        const bool ran = buffer_make(&r, INPUT, input->count * sizeof(float)) &&
                         buffer_make(&r, OUTPUT, output->count * sizeof(float)) &&
                         buffer_write(&r, INPUT, input->value) && texture_make(&r) && module_make(&r, path) &&
                         layouts_make(&r) && pipeline_make(&r) && set_make(&r) && dispatch(&r, groups) &&
                         buffer_read(&r, OUTPUT, output->value);
        result = ran ? SHADER_RAN : SHADER_FAILED;
    }
    runner_destroy(&r);
    return result;
}
