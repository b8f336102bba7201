// Writing probes.vdb: a tree of voxels for each level, and for its ghosts.
#include "vdb_cells.h"
#include "vdb_grids.hh"
#include "volume_internal.h"

#include <lambent/base64.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include <openvdb/openvdb.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>

namespace lmb_vdb {

void describe(openvdb::MetaMap &target, const lmb_probes &probes, uint32_t level, float scale)
{
    const lmb_lattice &lattice = probes.level[level].lattice;
    target.insertMeta("lambent_version", openvdb::Int32Metadata(kFormatVersion));
    target.insertMeta("lambent_levels", openvdb::Int32Metadata(static_cast<int32_t>(probes.level_count)));
    target.insertMeta("lambent_scale", openvdb::FloatMetadata(scale));
    target.insertMeta("lambent_spacing", openvdb::FloatMetadata(lattice.spacing));
    target.insertMeta("lambent_min",
                      openvdb::Vec3IMetadata(openvdb::Vec3i(lattice.min[0], lattice.min[1], lattice.min[2])));
    target.insertMeta("lambent_size",
                      openvdb::Vec3IMetadata(openvdb::Vec3i(lattice.size[0], lattice.size[1], lattice.size[2])));
    target.insertMeta("lambent_convention",
                      openvdb::StringMetadata("real orthonormal spherical harmonics with Condon-Shortley signs; "
                                              "right-handed world, +Y up"));
    target.insertMeta("lambent_basis", openvdb::StringMetadata("00 1-1 10 11 2-2 2-1 20 21 22"));
    target.insertMeta("lambent_units", openvdb::StringMetadata("radiance / lambent_scale, linear Rec. 709 as (x,y,z) = "
                                                               "(r,g,b); lengths in metres"));
    for (uint32_t key = 0; key < probes.key_light_count; ++key) {
        const lmb_vec3 &direction = probes.key_light[key].direction;
        target.insertMeta(key_direction_name(key),
                          openvdb::Vec3SMetadata(openvdb::Vec3s(direction.x, direction.y, direction.z)));
        target.insertMeta(key_irradiance_name(key),
                          openvdb::Vec3SMetadata(openvdb::Vec3s(probes.key_light[key].irradiance.c)));
    }
}

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

// OpenVDB's own file class does not notice a full disk; this one writes to a stream that its caller checks.
class Writer : public openvdb::io::Archive {
  public:
    void write_seekable(std::ostream &stream, const openvdb::GridCPtrVec &grids, const openvdb::MetaMap &metadata)
    {
        setCompression((hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) |
                       openvdb::io::COMPRESS_ACTIVE_MASK);
        openvdb::io::Archive::write(stream, grids, true, metadata);
    }
};

// Voxels, and the probes that are there.
struct Voxels {
    std::vector<Coord> at;
    std::vector<int32_t> probe;
};

// Of a level; a ghost is in the first layer that has none of its point yet.
struct Level {
    uint32_t number;
    Voxels own, ghosts;
    std::vector<uint8_t> layer_of_ghost; // [ghost of the level's]
};

void add_ghost(const lmb_probes &probes, int32_t ghost, LayerIndex &index, Level &level)
{
    GhostPlace place{{}, 1};
    std::copy_n(probes.point[ghost], 3, place.point);
    while (index.find(place.layer, place.point) >= 0) {
        ++place.layer;
    }
    const bool is_near = std::all_of(place.point, place.point + 3,
                                     [](int32_t at) { return at >= -kFarthestGhost && at <= kFarthestGhost; });
    if (place.layer > kMostLayers || !is_near) {
        fail(LMB_ERROR_ARGUMENT, is_near ? "a point has more than " + std::to_string(kMostLayers) + " ghosts"
                                         : "a ghost lies too far out for its voxel");
    }
    index.add(place.layer, place.point, ghost);
    level.ghosts.at.emplace_back(ghost_voxel(place, 0), ghost_voxel(place, 1), ghost_voxel(place, 2));
    level.ghosts.probe.push_back(ghost);
    level.layer_of_ghost.push_back(static_cast<uint8_t>(place.layer));
}

Level find_voxels(const lmb_probes &probes, uint32_t number)
{
    const lmb_probe_level &own = probes.level[number];
    Level level{number, {}, {}, {}};
    for (int32_t probe = own.first; probe < own.first + own.count; ++probe) {
        level.own.at.emplace_back(probes.point[probe]);
        level.own.probe.push_back(probe);
    }
    LayerIndex index;
    for (int32_t ghost = own.ghost_first; ghost < own.ghost_first + own.ghost_count; ++ghost) {
        add_ghost(probes, ghost, index, level);
    }
    return level;
}

// A level's cut cells as text.
std::string cut_cells_text(const lmb_probes &probes, const Level &level)
{
    const lmb_cut_cells &cut = probes.cut;
    std::vector<unsigned char> bytes;
    for (uint32_t i = 0; i < cut.count; ++i) {
        const lmb_cut_cell &from = cut.cell[i];
        if (from.level != level.number) {
            continue;
        }
        lmb_vdb_cell cell;
        std::copy_n(from.point, 3, cell.point);
        cell.plane_count = from.plane_count;
        cell.region_count = from.region_count;
        std::copy_n(cut.plane + from.plane_first, from.plane_count, cell.plane);
        for (uint32_t region = 0; region < from.region_count; ++region) {
            for (int corner = 0; corner < 8; ++corner) {
                const int32_t ghost =
                    cut.corner[from.region_first + region][corner] - probes.level[level.number].ghost_first;
                const bool is_ghost = ghost >= 0 && static_cast<size_t>(ghost) < level.layer_of_ghost.size();
                cell.layer[region][corner] = is_ghost ? level.layer_of_ghost[static_cast<size_t>(ghost)] : uint8_t(0);
            }
        }
        const size_t before = bytes.size();
        bytes.resize(before + LMB_VDB_CELL_BYTES_MOST);
        bytes.resize(before + lmb_vdb_cell_write(&cell, bytes.data() + before));
    }
    std::string text(lmb_base64_length(bytes.size()) + 1, '\0');
    lmb_base64_encode(bytes.data(), bytes.size(), &text[0]);
    text.pop_back();
    return text;
}

void describe_cut_cells(openvdb::MetaMap &validity, const lmb_probes &probes, const Level &level)
{
    const std::string text = cut_cells_text(probes, level);
    if (!level.ghosts.probe.empty() || !text.empty()) {
        validity.insertMeta("lambent_cut_cells", openvdb::StringMetadata(text));
    }
}

// ---------------------------------------------------------------------------------------------------- grids

FloatGrid::Ptr make_validity_grid(const lmb_probes &probes, const GridSet &set, const Voxels &voxels)
{
    FloatGrid::Ptr validity = FloatGrid::create(0.0f);
    validity->setName(validity_name(set));
    const double spacing = static_cast<double>(probes.level[set.level].lattice.spacing);
    validity->setTransform(
        openvdb::math::Transform::createLinearTransform(set.ghosts ? spacing / kGhostsAlong : spacing));
    FloatGrid::Accessor accessor = validity->getAccessor();
    for (size_t i = 0; i < voxels.at.size(); ++i) {
        accessor.setValue(voxels.at[i], probes.validity[voxels.probe[i]]);
    }
    return validity;
}

Vec3SGrid::Ptr make_coefficient_grid(const lmb_probes &probes, const Voxels &voxels, const FloatGrid &validity, int i,
                                     float scale)
{
    Vec3SGrid::Ptr coefficient = Vec3SGrid::create(
        std::make_shared<openvdb::Vec3STree>(validity.tree(), openvdb::Vec3s(0.0f), openvdb::TopologyCopy()));
    coefficient->setTransform(validity.transform().copy());
    coefficient->setSaveFloatAsHalf(true);
    coefficient->setVectorType(openvdb::VEC_INVARIANT);
    Vec3SGrid::Accessor accessor = coefficient->getAccessor();
    for (size_t k = 0; k < voxels.at.size(); ++k) {
        const lmb_sh3 *const channel = probes.radiance[0][voxels.probe[k]].channel;
        accessor.setValueOnly(voxels.at[k], openvdb::Vec3s(channel[0].c[i], channel[1].c[i], channel[2].c[i]) / scale);
    }
    return coefficient;
}

FloatGrid::Ptr make_visibility_grid(const lmb_probes &probes, const Voxels &voxels, const FloatGrid &validity,
                                    uint32_t key)
{
    FloatGrid::Ptr visibility =
        FloatGrid::create(std::make_shared<openvdb::FloatTree>(validity.tree(), 0.0f, openvdb::TopologyCopy()));
    visibility->setTransform(validity.transform().copy());
    FloatGrid::Accessor accessor = visibility->getAccessor();
    for (size_t i = 0; i < voxels.at.size(); ++i) {
        accessor.setValueOnly(voxels.at[i], probes.key_visibility[voxels.probe[i]][key]);
    }
    return visibility;
}

// Appends a set's grids. @return its validity
FloatGrid::Ptr add_set(const lmb_probes &probes, const GridSet &set, const Voxels &voxels, float scale,
                       openvdb::GridPtrVec &grids)
{
    const FloatGrid::Ptr validity = make_validity_grid(probes, set, voxels);
    const size_t first = grids.size();
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        grids.push_back(make_coefficient_grid(probes, voxels, *validity, i, scale));
        grids.back()->setName(coefficient_name(i, set));
    }
    grids.push_back(validity);
    for (uint32_t key = 0; key < probes.key_light_count; ++key) {
        grids.push_back(make_visibility_grid(probes, voxels, *validity, key));
        grids.back()->setName(visibility_name(key, set));
    }
    for (size_t i = first; i < grids.size(); ++i) {
        describe(*grids[i], probes, set.level, scale);
        grids[i]->setCreator("Lambent");
    }
    return validity;
}

void check_magnitudes(const lmb_probes &probes, float scale)
{
    for (int32_t probe = 0; probe < probes.count; ++probe) {
        for (const lmb_sh3 &channel : probes.radiance[0][probe].channel) {
            for (const float value : channel.c) {
                if (!(std::fabs(value / scale) <= LMB_HALF_MAX)) {
                    fail(LMB_ERROR_ARGUMENT, "probe " + std::to_string(probe) + " has radiance of " +
                                                 std::to_string(value) + ", which no scale brings into fp16");
                }
            }
        }
    }
}

} // namespace

void write_file(const std::string &path, const lmb_probes &probes, const lmb_vdb_metadata &metadata)
{
    const float scale = lmb_probes_scale(&probes);
    check_magnitudes(probes, scale);
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (uint32_t number = 0; number < probes.level_count; ++number) {
        const Level level = find_voxels(probes, number);
        describe_cut_cells(*add_set(probes, {number, false}, level.own, scale, grids), probes, level);
        if (!level.ghosts.probe.empty()) {
            add_set(probes, {number, true}, level.ghosts, scale, grids);
        }
    }
    add_locals(probes, scale, *grids[LMB_SH3_COUNT], grids); // the finest level's validity follows its coefficients
    openvdb::MetaMap file_metadata;
    describe(file_metadata, probes, 0, scale);
    file_metadata.insertMeta("lambent_settings", openvdb::StringMetadata(metadata.settings));
    file_metadata.insertMeta("lambent_scene_hash", openvdb::StringMetadata(metadata.scene_hash));

    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    if (file) {
        Writer().write_seekable(file, openvdb::GridCPtrVec(grids.begin(), grids.end()), file_metadata);
    }
    file.close();
    if (!file) {
        fail(LMB_ERROR_WRITE, std::string("cannot write: ") + std::strerror(errno));
    }
    overwrite_uuid(path);
}

} // namespace lmb_vdb
