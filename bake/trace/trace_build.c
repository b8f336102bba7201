/* Building the BVH, and what is known of each instance and material beside it. */
#include <lambent/trace.h>

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/affine.h"
#include "trace/inside_out.h"
#include "trace/trace_embree.h"

/* Up to this many placed triangles every instance becomes geometry of its own in world space, which traces faster
 * (lambent_growth); beyond it, meshes that are used more than once become Embree instances. */
#define FLATTEN_MAX_TRIANGLES 16000000u

static bool count_bytes(void *context, ssize_t bytes, bool post)
{
    (void)post;
    __atomic_fetch_add(&((lmb_tracer *)context)->bytes, (long long)bytes, __ATOMIC_RELAXED);
    return true;
}

static bool mesh_has_layers(const lmb_tracer *tracer, const lmb_mesh *mesh)
{
    bool any = false;
    for (uint32_t i = 0; i < mesh->triangle_count && !any; ++i) {
        any = tracer->is_see_through[mesh->material[i]];
    }
    return any;
}

static bool layers_note(lmb_tracer *tracer)
{
    const lmb_scene *scene = tracer->scene;
    bool *of_mesh = calloc(scene->mesh_count + 1u, sizeof *of_mesh);
    tracer->coverage = calloc(scene->material_count + 1u, sizeof *tracer->coverage);
    if (!of_mesh || !tracer->coverage) {
        free(of_mesh);
        return false;
    }
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        tracer->coverage[i] = lmb_material_coverage_of_factors(&scene->materials[i]);
    }
    for (uint32_t i = 0; i < scene->mesh_count; ++i) {
        of_mesh[i] = mesh_has_layers(tracer, &scene->meshes[i]);
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        tracer->has_layers[i] = of_mesh[scene->instances[i].mesh];
    }
    free(of_mesh);
    return true;
}

/* Triangles of a mesh, at `to_world` or in mesh space when that is NULL. Returns Embree's vertex buffer. */
static lmb_vec3 *geometry_add(lmb_tracer *tracer, RTCScene scene, unsigned id, const lmb_mesh *mesh,
                              const lmb_affine *to_world)
{
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) {
        return NULL;
    }
    /* Embree wants readable bytes past the last vertex; its own buffers have them. */
    lmb_vec3 *vertex = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(lmb_vec3),
                                               mesh->vertex_count);
    uint32_t *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), mesh->triangle_count);
    if (vertex && index) {
        for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
            vertex[i] = to_world ? affine_point(to_world, mesh->position[i]) : mesh->position[i];
        }
        memcpy(index, mesh->triangle, mesh->triangle_count * sizeof mesh->triangle[0]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene, geometry, id);
    }
    rtcReleaseGeometry(geometry);
    return index ? vertex : NULL;
}

static RTCScene scene_new(lmb_tracer *tracer)
{
    RTCScene scene = rtcNewScene(tracer->device);
    if (scene) {
        /* Spatial splits, of a build of high quality, would show a filter a triangle more than once. */
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
        /* Robust: no ray may slip between two triangles that share an edge. The filter counts crossings. */
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    }
    return scene;
}

static bool instance_add(lmb_tracer *tracer, unsigned id, const lmb_instance *instance)
{
    const lmb_mesh *mesh = &tracer->scene->meshes[instance->mesh];
    RTCScene *shared = &tracer->mesh_scene[instance->mesh];
    if (!*shared) {
        *shared = scene_new(tracer);
        if (!*shared || !geometry_add(tracer, *shared, 0, mesh, NULL)) {
            return false;
        }
        rtcCommitScene(*shared);
    }
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE);
    if (!geometry) {
        return false;
    }
    float transform[12];
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            transform[4 * row + column] = (float)instance->to_world.m[row][column];
        }
    }
    rtcSetGeometryInstancedScene(geometry, *shared);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, transform);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tracer->world, geometry, id);
    rtcReleaseGeometry(geometry);
    return true;
}

static bool geometry_build(lmb_tracer *tracer)
{
    const lmb_scene *scene = tracer->scene;
    uint64_t placed = 0;
    uint32_t *uses = calloc(scene->mesh_count + 1u, sizeof *uses);
    if (!uses) {
        return false;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        placed += scene->meshes[scene->instances[i].mesh].triangle_count;
        ++uses[scene->instances[i].mesh];
    }
    bool good = true;
    for (uint32_t i = 0; i < scene->instance_count && good; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        const lmb_mesh *mesh = &scene->meshes[instance->mesh];
        if (instance->dynamic || mesh->triangle_count == 0) {
            continue;
        }
        if (placed <= FLATTEN_MAX_TRIANGLES || uses[instance->mesh] == 1) {
            tracer->world_vertex[i] = geometry_add(tracer, tracer->world, i, mesh, &instance->to_world);
            good = tracer->world_vertex[i] != NULL;
        } else {
            good = instance_add(tracer, i, instance);
        }
    }
    free(uses);
    if (good) {
        rtcCommitScene(tracer->world);
    }
    return good && rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE;
}

/* Embree falls back without a word on names that it does not know. */
static bool isa_is_known(const char *isa)
{
    static const char *const names[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        if (strcmp(isa, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* From here on, the fronts of what is inside out are those that are seen. */
static bool inside_out_turn(lmb_tracer *tracer)
{
    uint8_t *const facing = calloc(tracer->scene->instance_count + 1u, sizeof *facing);
    const bool good = facing && lmb_inside_out_find(tracer, facing) == LMB_OK;
    for (uint32_t i = 0; good && i < tracer->scene->instance_count; ++i) {
        tracer->facing[i] = facing[i];
        tracer->is_mirrored[i] = tracer->is_mirrored[i] != (facing[i] == LMB_FACING_TURNED);
    }
    free(facing);
    return good;
}

lmb_result lmb_tracer_create(const lmb_scene *scene, const char *isa, int threads, lmb_tracer **tracer,
                             lmb_error *error)
{
    if (isa && !isa_is_known(isa)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "there is no instruction set '%s'", isa);
    }
    char config[128];
    snprintf(config, sizeof config, "%s%s%sthreads=%d", isa ? "isa=" : "", isa ? isa : "", isa ? "," : "",
             threads > 0 ? threads : 0);
    lmb_tracer *created = calloc(1, sizeof *created);
    if (!created) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    created->scene = scene;
    created->mesh_scene = calloc(scene->mesh_count + 1u, sizeof(RTCScene));
    created->world_vertex = calloc(scene->instance_count + 1u, sizeof *created->world_vertex);
    created->is_see_through = calloc(scene->material_count + 1u, sizeof *created->is_see_through);
    created->is_mirrored = calloc(scene->instance_count + 1u, sizeof *created->is_mirrored);
    created->has_layers = calloc(scene->instance_count + 1u, sizeof *created->has_layers);
    created->facing = calloc(scene->instance_count + 1u, sizeof *created->facing);
    if (!created->mesh_scene || !created->world_vertex || !created->is_see_through || !created->is_mirrored ||
        !created->has_layers || !created->facing) {
        lmb_tracer_destroy(created);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        created->is_see_through[i] = !lmb_material_is_opaque(&scene->materials[i]);
        created->any_see_through |= created->is_see_through[i];
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        created->is_mirrored[i] = scene->instances[i].mirrored;
    }
    if (created->any_see_through && !layers_note(created)) {
        lmb_tracer_destroy(created);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    created->device = rtcNewDevice(config);
    const enum RTCError fault = rtcGetDeviceError(created->device); /* of a device that could not be made too */
    if (!created->device || fault != RTC_ERROR_NONE) {
        lmb_tracer_destroy(created);
        if (fault == RTC_ERROR_OUT_OF_MEMORY || fault == RTC_ERROR_UNKNOWN) {
            return lmb_error_set(error, LMB_ERROR_MEMORY, "Embree cannot start: out of memory, or of threads");
        }
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "Embree cannot start here%s%s", isa ? " with isa " : "",
                             isa ? isa : "");
    }
    rtcSetDeviceMemoryMonitorFunction(created->device, count_bytes, created);
    created->world = scene_new(created);
    if (!created->world || !geometry_build(created) || !inside_out_turn(created)) {
        lmb_tracer_destroy(created);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory while building the BVH");
    }
    *tracer = created;
    return LMB_OK;
}

void lmb_tracer_destroy(lmb_tracer *tracer)
{
    if (!tracer) {
        return;
    }
    if (tracer->world) {
        rtcReleaseScene(tracer->world);
    }
    for (uint32_t i = 0; tracer->mesh_scene && i < tracer->scene->mesh_count; ++i) {
        if (tracer->mesh_scene[i]) {
            rtcReleaseScene(tracer->mesh_scene[i]);
        }
    }
    if (tracer->device) {
        rtcReleaseDevice(tracer->device);
    }
    free(tracer->mesh_scene);
    free(tracer->world_vertex);
    free(tracer->is_see_through);
    free(tracer->coverage);
    free(tracer->is_mirrored);
    free(tracer->facing);
    free(tracer->has_layers);
    free(tracer);
}

const lmb_scene *lmb_tracer_scene(const lmb_tracer *tracer)
{
    return tracer->scene;
}

lmb_facing lmb_tracer_facing(const lmb_tracer *tracer, uint32_t instance)
{
    return (lmb_facing)tracer->facing[instance];
}

bool lmb_tracer_is_turned(const lmb_tracer *tracer, uint32_t instance)
{
    return tracer->facing[instance] == LMB_FACING_TURNED;
}

const lmb_vec3 *lmb_tracer_world_vertices(const lmb_tracer *tracer, uint32_t instance)
{
    return tracer->world_vertex[instance];
}

struct RTCSceneTy *lmb_tracer_world(const lmb_tracer *tracer)
{
    return tracer->world;
}

void lmb_tracer_record(lmb_tracer *tracer, lmb_ray_recorder *recorder)
{
    tracer->recorder = recorder;
}

size_t lmb_tracer_bytes(const lmb_tracer *tracer)
{
    return tracer->bytes > 0 ? (size_t)tracer->bytes : 0;
}
