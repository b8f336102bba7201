// Local sets in probes.vdb: dense little grids with a transform of their own.
#include "vdb_grids.hh"
#include "volume_internal.h"

#include <cmath>

namespace lmb_vdb {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

std::string local_suffix(uint32_t number)
{
    return "_local_" + std::to_string(number);
}

// Probe i + size[0] (j + size[1] k) is voxel (i, j, k).
Coord voxel_of(const lmb_local_frame &frame, uint32_t probe)
{
    return Coord(static_cast<int>(probe % frame.size[0]), static_cast<int>(probe / frame.size[0] % frame.size[1]),
                 static_cast<int>(probe / frame.size[0] / frame.size[1]));
}

// OpenVDB's vectors are rows.
openvdb::math::Transform::Ptr transform_of(const lmb_local_frame &frame)
{
    openvdb::math::Mat4d rows = openvdb::math::Mat4d::identity();
    for (int axis = 0; axis < 3; ++axis) {
        const lmb_vec3 &step = frame.step[axis];
        rows.setRow(axis, openvdb::Vec4d(double(step.x), double(step.y), double(step.z), 0.0));
    }
    rows.setRow(3, openvdb::Vec4d(frame.origin.x, frame.origin.y, frame.origin.z, 1.0));
    return openvdb::math::Transform::createLinearTransform(rows);
}

void finish_grid(const lmb_probes &probes, const lmb_probe_local &local, float scale, const std::string &name,
                 openvdb::GridBase &grid)
{
    grid.setName(name);
    grid.setTransform(transform_of(local.frame));
    grid.setCreator("Lambent");
    describe(grid, probes, 0, scale);
    grid.removeMeta("lambent_spacing");
    grid.insertMeta("lambent_min", openvdb::Vec3IMetadata(openvdb::Vec3i(0)));
    grid.insertMeta("lambent_size", openvdb::Vec3IMetadata(openvdb::Vec3i(static_cast<int>(local.frame.size[0]),
                                                                          static_cast<int>(local.frame.size[1]),
                                                                          static_cast<int>(local.frame.size[2]))));
    grid.insertMeta("lambent_local_name", openvdb::StringMetadata(local.name));
    grid.insertMeta("lambent_local_node", openvdb::Int32Metadata(local.node));
    grid.insertMeta("lambent_local_place", openvdb::Int32Metadata(local.place));
}

void add_coefficients(const lmb_probes &probes, uint32_t number, float scale, openvdb::GridPtrVec &grids)
{
    const lmb_probe_local &local = probes.local[number];
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        const Vec3SGrid::Ptr grid = Vec3SGrid::create();
        grid->setSaveFloatAsHalf(true);
        grid->setVectorType(openvdb::VEC_INVARIANT);
        for (uint32_t k = 0; k < lmb_local_frame_count(&local.frame); ++k) {
            const lmb_sh3 *const channel = local.radiance[k].channel;
            const openvdb::Vec3s value(channel[0].c[i], channel[1].c[i], channel[2].c[i]);
            for (int c = 0; c < 3; ++c) {
                if (!(std::fabs(value[c] / scale) <= LMB_HALF_MAX)) {
                    fail(LMB_ERROR_ARGUMENT,
                         std::string("local set '") + local.name + "' has radiance which no scale brings into fp16");
                }
            }
            grid->tree().setValueOn(voxel_of(local.frame, k), value / scale);
        }
        finish_grid(probes, local, scale, coefficient_name(i, {0, false}) + local_suffix(number), *grid);
        grids.push_back(grid);
    }
}

// A frame is what the transform and the active voxels say.
lmb_local_frame read_frame(const FloatGrid &validity)
{
    openvdb::CoordBBox box;
    lmb_local_frame frame{};
    if (validity.transform().isLinear() && validity.tree().evalActiveVoxelBoundingBox(box) && box.min() == Coord(0)) {
        const openvdb::math::Mat4d rows = validity.transform().baseMap()->getAffineMap()->getMat4();
        frame.origin = {rows(3, 0), rows(3, 1), rows(3, 2)};
        for (int axis = 0; axis < 3; ++axis) {
            frame.step[axis] = {float(rows(axis, 0)), float(rows(axis, 1)), float(rows(axis, 2))};
            const int size = box.max()[axis] < LMB_LOCAL_SET_SIDE ? box.max()[axis] + 1 : 0;
            frame.size[axis] = static_cast<uint32_t>(size);
        }
    }
    if (!lmb_local_frame_is_valid(&frame) || validity.activeVoxelCount() != lmb_local_frame_count(&frame)) {
        fail(LMB_ERROR_FORMAT, "grid " + validity.getName() +
                                   " is no local set: a box of up to 8 x 8 x 8 voxels from "
                                   "(0, 0, 0) on, all active, with axes at right angles");
    }
    return frame;
}

void check_like(const openvdb::GridBase &grid, const FloatGrid &validity)
{
    if (grid.activeVoxelCount() != validity.activeVoxelCount() || grid.transform() != validity.transform()) {
        fail(LMB_ERROR_FORMAT,
             "grids " + grid.getName() + " and " + validity.getName() + " differ in transform or active voxels");
    }
}

// The value of a voxel that must be active.
template <typename GridType> typename GridType::ValueType value_at(const GridType &grid, const Coord &voxel)
{
    typename GridType::ValueType value;
    if (!grid.tree().probeValue(voxel, value)) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " lacks a voxel of its local set");
    }
    return value;
}

int32_t read_number(const openvdb::GridBase &grid, const char *name)
{
    const auto number = grid.getMetadata<openvdb::Int32Metadata>(name);
    if (!number || number->value() < 0) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " has no usable " + name);
    }
    return number->value();
}

LocalGrids find_local(const GridMap &grids, uint32_t number, uint32_t key_lights)
{
    const std::string suffix = local_suffix(number);
    LocalGrids found{};
    found.validity = find_grid<FloatGrid>(grids, validity_name({0, false}) + suffix);
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        found.coefficient[i] = find_grid<Vec3SGrid>(grids, coefficient_name(i, {0, false}) + suffix);
    }
    for (uint32_t key = 0; key < key_lights; ++key) {
        found.visibility.push_back(find_grid<FloatGrid>(grids, visibility_name(key, {0, false}) + suffix));
    }
    const auto name = found.validity->getMetadata<openvdb::StringMetadata>("lambent_local_name");
    if (!name) {
        fail(LMB_ERROR_FORMAT, "grid " + found.validity->getName() + " has no usable lambent_local_name");
    }
    found.name = name->value();
    found.node = read_number(*found.validity, "lambent_local_node");
    found.place = read_number(*found.validity, "lambent_local_place");
    return found;
}

} // namespace

void add_locals(const lmb_probes &probes, float scale, openvdb::GridBase &validity, openvdb::GridPtrVec &grids)
{
    if (probes.local_count > 0) {
        validity.insertMeta("lambent_local_sets", openvdb::Int32Metadata(static_cast<int32_t>(probes.local_count)));
    }
    for (uint32_t number = 0; number < probes.local_count; ++number) {
        const lmb_probe_local &local = probes.local[number];
        const uint32_t count = lmb_local_frame_count(&local.frame);
        add_coefficients(probes, number, scale, grids);
        for (uint32_t which = 0; which <= probes.key_light_count; ++which) {
            const FloatGrid::Ptr grid = FloatGrid::create(0.0f);
            for (uint32_t k = 0; k < count; ++k) {
                const float value = which == 0 ? local.validity[k] : local.key_visibility[k][which - 1];
                grid->tree().setValueOn(voxel_of(local.frame, k), value);
            }
            const std::string name = which == 0 ? validity_name({0, false}) : visibility_name(which - 1, {0, false});
            finish_grid(probes, local, scale, name + local_suffix(number), *grid);
            grids.push_back(grid);
        }
    }
}

std::vector<LocalGrids> find_locals(const GridMap &grids, const FloatGrid &validity, uint32_t key_lights)
{
    std::vector<LocalGrids> locals;
    if (validity["lambent_local_sets"]) {
        const int32_t count = read_number(validity, "lambent_local_sets");
        for (uint32_t number = 0; number < static_cast<uint32_t>(count); ++number) {
            locals.push_back(find_local(grids, number, key_lights));
        }
    }
    return locals;
}

void read_local(const LocalGrids &local, lmb_probes &probes)
{
    const lmb_local_frame frame = read_frame(*local.validity);
    const lmb_result added = lmb_probes_add_local(&probes, local.name.c_str(), local.node, local.place, &frame);
    if (added != LMB_OK) {
        fail(added == LMB_ERROR_MEMORY ? added : LMB_ERROR_FORMAT, "a local set cannot be added");
    }
    const lmb_probe_local &to = probes.local[probes.local_count - 1];
    const uint32_t count = lmb_local_frame_count(&frame);
    for (uint32_t k = 0; k < count; ++k) {
        to.validity[k] = value_at(*local.validity, voxel_of(frame, k));
    }
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        const Vec3SGrid &grid = *local.coefficient[i];
        check_like(grid, *local.validity);
        check_version(grid);
        const float scale = read_scale(grid);
        for (uint32_t k = 0; k < count; ++k) {
            const openvdb::Vec3s value = value_at(grid, voxel_of(frame, k));
            for (int c = 0; c < 3; ++c) {
                to.radiance[k].channel[c].c[i] = value[c] * scale;
            }
        }
    }
    for (uint32_t key = 0; key < local.visibility.size(); ++key) {
        check_like(*local.visibility[key], *local.validity);
        for (uint32_t k = 0; k < count; ++k) {
            to.key_visibility[k][key] = value_at(*local.visibility[key], voxel_of(frame, k));
        }
    }
}

} // namespace lmb_vdb
