#include "shader_runner.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vulkan/vulkan.h>

enum { BUFFERS = 2 };

/* Everything that is made, in this order; what is not stays 0, which Vulkan destroys without a word. */
typedef struct runner {
    VkInstance instance;
    VkPhysicalDevice physical;
    uint32_t family; /* of queues, one that computes */
    VkDevice device;
    VkBuffer buffer[BUFFERS];
    VkDeviceMemory memory[BUFFERS];
    VkDeviceSize size[BUFFERS];
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
            if (families[k].queueFlags & VK_QUEUE_COMPUTE_BIT) {
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
    const VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
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
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
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

static bool buffer_write(const runner *r, int which, const float *from)
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
    VkDescriptorSetLayoutBinding bindings[BUFFERS];
    for (uint32_t i = 0; i < BUFFERS; ++i) {
        bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
                                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                     .descriptorCount = 1,
                                                     .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    const VkDescriptorSetLayoutCreateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = BUFFERS, .pBindings = bindings};
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
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BUFFERS};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
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
    for (uint32_t i = 0; i < BUFFERS; ++i) {
        const VkDescriptorBufferInfo buffer = {r->buffer[i], 0, VK_WHOLE_SIZE};
        const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = r->set,
                                            .dstBinding = i,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                            .pBufferInfo = &buffer};
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

shader_run_result shader_run(const char *path, unsigned groups, const float *input, size_t input_count, float *output,
                             size_t output_count)
{
    runner r = {0};
    shader_run_result result = SHADER_NO_DEVICE;
    if (instance_make(&r) && device_find(&r) && device_make(&r)) {
        const bool ran = buffer_make(&r, 0, input_count * sizeof *input) &&
                         buffer_make(&r, 1, output_count * sizeof *output) && buffer_write(&r, 0, input) &&
                         module_make(&r, path) && layouts_make(&r) && pipeline_make(&r) && set_make(&r) &&
                         dispatch(&r, groups) && buffer_read(&r, 1, output);
        result = ran ? SHADER_RAN : SHADER_FAILED;
    }
    runner_destroy(&r);
    return result;
}
