#include "gltf/gltf_lights.hh"

#include <algorithm>

#include <lambent/vector.h>

extern "C" {
#include "base/trig.h"
}
#include "gltf/gltf_append.hh"
#include "gltf/gltf_transform.h"
#include "gltf/gltf_value.hh"
#include "gltf/gltf_world.hh"

namespace lmb_gltf {

namespace {

/* Exporters write such a range for lamps that reach everywhere. */
constexpr double UNLIMITED_RANGE = LMB_GLTF_FARTHEST;

/* Why a lamp cannot give light where it is, or NULL. */
const char *light_fault(const tinygltf::Light &source, const lmb_affine &to_world)
{
    const lmb_gltf_rank rank = lmb_gltf_transform_rank(&to_world);
    return source.intensity < 0.0                            ? "its intensity is negative"
           : rank == LMB_GLTF_NOTHING                        ? "its node is scaled to nothing"
           : rank == LMB_GLTF_FLAT && source.type != "point" ? "its node is scaled flat, and gives it no direction"
                                                             : nullptr;
}

lmb_light_type type_of(const std::string &word)
{
    return word == "spot" ? LMB_LIGHT_SPOT : word == "directional" ? LMB_LIGHT_DIRECTIONAL : LMB_LIGHT_POINT;
}

void set_cone(const tinygltf::SpotLight &spot, lmb_light &light)
{
    double sine, inner, outer;
    lmb_sincos(spot.innerConeAngle, &sine, &inner);
    lmb_sincos(spot.outerConeAngle, &sine, &outer);
    light.cos_outer = float(std::min(outer, 1.0));
    light.cos_inner = std::max(float(std::min(inner, 1.0)), light.cos_outer);
}

} // namespace

void add_light(const document &document, uint32_t index, uint32_t node, const lmb_affine &to_world, lmb_scene &scene,
               const lmb_warnings &warnings)
{
    const tinygltf::Light &source = document.model.lights[index];
    const lmb_gltf_marks &marks = document.marks[node];
    const std::string node_name = document.node_name(node), name = source.name.empty() ? node_name : source.name;
    const char *const fault = light_fault(source, to_world);
    if (fault) {
        lmb_warn(&warnings, "%s: node '%s': lamp '%s' is left out: %s", document.file->path, node_name.c_str(),
                 name.c_str(), fault);
        return;
    }
    lmb_light light{};
    light.type = type_of(source.type);
    light.indirect_only = marks.light == LMB_GLTF_INDIRECT;
    if (light.type == LMB_LIGHT_DIRECTIONAL) {
        light.angle_rad = std::min(float(marks.angle_deg) * (LMB_PI_F / 180.0f), LMB_PI_F);
    } else {
        light.radius = float(marks.radius_m);
    }
    light.set = light_set_of(document, scene, marks.light_set, "node '" + node_name + "'", warnings);
    light.position = origin_of(to_world);
    light.direction = lmb_gltf_forward(&to_world);
    const double scale = scale_of(document.options.light_scale);
    for (size_t c = 0; c < 3; ++c) {
        const double colour = source.color.size() == 3 ? std::max(source.color[c], 0.0) : 1.0;
        light.intensity.c[c] = to_float(colour * source.intensity * scale);
    }
    light.range = source.range < UNLIMITED_RANGE ? float(source.range) : 0.0f;
    set_cone(source.spot, light);
    lmb_light &added = append(scene.lights, scene.light_count);
    added = light;
    added.name = copy_string(name);
}

} // namespace lmb_gltf
