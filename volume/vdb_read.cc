// Reading probes.vdb: whatever the file claims is looked at before it is believed.
#include "vdb_cells.h"
#include "vdb_grids.hh"

#include <lambent/base64.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>

#include <openvdb/openvdb.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>

namespace lmb_vdb {
namespace {

// Tiles of a few bytes may stand for any number.
constexpr openvdb::Index64 kMostProbes = openvdb::Index64(1) << 28;

// Spacings of more would not fit into a float of the finest one's.
constexpr int32_t kMostLevels = 32;

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

struct ProbesDeleter {
    void operator()(lmb_probes *probes) const
    {
        lmb_probes_destroy(probes);
    }
};
using ProbesHandle = std::unique_ptr<lmb_probes, ProbesDeleter>;

struct FreeDeleter {
    void operator()(char *text) const
    {
        std::free(text);
    }
};
using TextHandle = std::unique_ptr<char, FreeDeleter>;

void check(lmb_result result, const char *what)
{
    if (result != LMB_OK) {
        fail(result == LMB_ERROR_MEMORY ? result : LMB_ERROR_FORMAT, what);
    }
}

// A set's grids, its voxels, and the probes that they become.
struct SetGrids {
    GridSet set;
    Vec3SGrid::Ptr coefficient[LMB_SH3_COUNT];
    FloatGrid::Ptr validity;
    std::vector<FloatGrid::Ptr> visibility; // of key lights
    std::vector<Coord> voxel;
    std::vector<int32_t> probe;
};

struct LevelGrids {
    std::vector<SetGrids> set; // its probes, and its ghosts where it has some
    std::vector<unsigned char> cut_cells;
};

struct Contents {
    std::vector<LevelGrids> level;
    std::vector<LocalGrids> local;
    openvdb::MetaMap::Ptr metadata;
};

// --------------------------------------------------------------------------------------------- finding grids

} // namespace

// The metadata alone tells whether it is worth reading the rest. The version stands on every grid.
void check_version(const openvdb::MetaMap &grid)
{
    const openvdb::Int32Metadata::ConstPtr version = grid.getMetadata<openvdb::Int32Metadata>("lambent_version");
    if (!version) {
        fail(LMB_ERROR_FORMAT, "not written by Lambent: grid sh_0 has no lambent_version, so its units and signs are "
                               "unknown");
    }
    if (version->value() != kFormatVersion) {
        fail(LMB_ERROR_VERSION, "format version " + std::to_string(version->value()) + " is not " +
                                    std::to_string(kFormatVersion) + ", which this Lambent reads");
    }
}

float read_scale(const openvdb::GridBase &grid)
{
    const openvdb::FloatMetadata::ConstPtr scale = grid.getMetadata<openvdb::FloatMetadata>("lambent_scale");
    if (!scale || !std::isfinite(scale->value()) || !(scale->value() > 0.0f)) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " has no usable lambent_scale");
    }
    return scale->value();
}

namespace {

void check_descriptors(const std::string &path)
{
    openvdb::io::File file(path);
    file.open(false);
    if (!file.hasGrid("sh_0")) {
        fail(LMB_ERROR_FORMAT, "not written by Lambent: has no grid sh_0");
    }
    check_version(*file.readGridMetadata("sh_0"));
    file.close();
}

// Of the grid that probes are known by.
uint32_t key_light_count(const openvdb::MetaMap &grid)
{
    uint32_t count = 0;
    while (grid[key_direction_name(count)]) {
        if (++count > LMB_KEY_LIGHTS_MOST) {
            fail(LMB_ERROR_FORMAT, "has more than " + std::to_string(LMB_KEY_LIGHTS_MOST) + " key lights");
        }
    }
    return count;
}

uint32_t read_level_count(const openvdb::GridBase &grid)
{
    const auto count = grid.getMetadata<openvdb::Int32Metadata>("lambent_levels");
    if (!count || count->value() < 1 || count->value() > kMostLevels) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " has no usable lambent_levels");
    }
    return static_cast<uint32_t>(count->value());
}

std::vector<unsigned char> read_cut_cells(const openvdb::GridBase &validity)
{
    const auto text = validity.getMetadata<openvdb::StringMetadata>("lambent_cut_cells");
    if (!text) {
        fail(LMB_ERROR_FORMAT, "grid " + validity.getName() + " has no usable lambent_cut_cells");
    }
    std::vector<unsigned char> bytes(text->value().size() + 1);
    size_t size = 0;
    if (!lmb_base64_decode(text->value().c_str(), bytes.data(), &size)) {
        fail(LMB_ERROR_FORMAT, "grid " + validity.getName() + ": lambent_cut_cells is broken");
    }
    bytes.resize(size);
    return bytes;
}

// Calls `visit` with each of a level's cut cells.
template <typename Visit> void for_each_cut_cell(const LevelGrids &level, const Visit &visit)
{
    const unsigned char *at = level.cut_cells.data();
    size_t size = level.cut_cells.size();
    while (size > 0) {
        lmb_vdb_cell cell;
        if (!lmb_vdb_cell_read(&at, &size, &cell)) {
            fail(LMB_ERROR_FORMAT, "grid " + level.set[0].validity->getName() + ": lambent_cut_cells is broken");
        }
        visit(cell);
    }
}

SetGrids find_set(const GridMap &grids, const GridSet &set, uint32_t key_lights)
{
    SetGrids found{set, {}, find_grid<FloatGrid>(grids, validity_name(set)), {}, {}, {}};
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        found.coefficient[i] = find_grid<Vec3SGrid>(grids, coefficient_name(i, set));
    }
    for (uint32_t key = 0; key < key_lights; ++key) {
        found.visibility.push_back(find_grid<FloatGrid>(grids, visibility_name(key, set)));
    }
    return found;
}

std::vector<LevelGrids> find_levels(const GridMap &grids)
{
    const FloatGrid &finest = *find_grid<FloatGrid>(grids, validity_name({0, false}));
    const uint32_t key_lights = key_light_count(finest);
    std::vector<LevelGrids> levels(read_level_count(finest));
    for (uint32_t number = 0; number < levels.size(); ++number) {
        LevelGrids &level = levels[number];
        level.set.push_back(find_set(grids, {number, false}, key_lights));
        const FloatGrid &validity = *level.set[0].validity;
        const bool has_ghosts = grids.count(validity_name({number, true})) > 0;
        if (has_ghosts) {
            level.set.push_back(find_set(grids, {number, true}, key_lights));
        }
        if (has_ghosts || validity["lambent_cut_cells"]) {
            level.cut_cells = read_cut_cells(validity);
        }
    }
    return levels;
}

Contents read_contents(const std::string &path)
{
    std::ifstream stream(path, std::ios::binary);
    char magic[4] = {};
    stream.read(magic, sizeof magic);
    if (!stream || std::memcmp(magic, " BDV", sizeof magic) != 0) {
        fail(LMB_ERROR_FORMAT, "not a .vdb file");
    }
    check_uuid(path);
    check_structure(path);
    check_descriptors(path);

    // OpenVDB does not look whether a read succeeded: the stream throws instead.
    stream.seekg(0);
    stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    Contents contents;
    try {
        openvdb::io::Stream archive(stream, false);
        GridMap grids;
        for (const openvdb::GridBase::Ptr &grid : *archive.getGrids()) {
            if (grid) {
                grids.emplace(grid->getName(), grid);
            }
        }
        contents.level = find_levels(grids);
        const SetGrids &finest = contents.level[0].set[0];
        contents.local = find_locals(grids, *finest.validity, static_cast<uint32_t>(finest.visibility.size()));
        contents.metadata = archive.getMetadata();
    } catch (const std::ios::failure &) {
        fail(LMB_ERROR_FORMAT, "the file is cut short");
    }
    return contents;
}

// -------------------------------------------------------------------------------------------------- lattices

// Lattice coordinates are voxel coordinates: metres = spacing * voxel, nothing else.
float read_spacing(const openvdb::GridBase &grid)
{
    const double spacing = grid.transform().voxelSize()[0];
    openvdb::math::Mat4d expected;
    expected.setToScale(openvdb::Vec3d(spacing));
    if (!grid.transform().isLinear() ||
        !grid.transform().baseMap()->getAffineMap()->getMat4().eq(expected, 1e-6 * spacing)) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " was moved, turned or scaled unevenly");
    }
    return static_cast<float>(spacing);
}

Coord ghost_point(const Coord &voxel)
{
    return Coord(ghost_place(voxel.asPointer()).point);
}

// The box that was written, where it still holds all of a level's voxels; else the box around them.
CoordBBox read_box(const LevelGrids &level)
{
    const FloatGrid &validity = *level.set[0].validity;
    CoordBBox box;
    bool has_probes = false;
    for (const SetGrids &set : level.set) {
        CoordBBox around;
        if (set.validity->tree().evalActiveVoxelBoundingBox(around)) {
            box.expand(set.set.ghosts ? CoordBBox(ghost_point(around.min()), ghost_point(around.max())) : around);
            has_probes = true;
        }
    }
    const auto min = validity.getMetadata<openvdb::Vec3IMetadata>("lambent_min");
    const auto size = validity.getMetadata<openvdb::Vec3IMetadata>("lambent_size");
    if (min && size) {
        bool holds = true;
        for (int axis = 0; axis < 3; ++axis) {
            const int64_t first = min->value()[axis];
            const int64_t last = first + size->value()[axis] - 1;
            holds = holds && size->value()[axis] >= 1 && last <= INT32_MAX &&
                    (!has_probes || (first <= box.min()[axis] && last >= box.max()[axis]));
        }
        if (holds) {
            return CoordBBox(Coord(min->value().asPointer()),
                             Coord(min->value().asPointer()) + Coord(size->value().asPointer()).offsetBy(-1));
        }
    }
    if (!has_probes) {
        fail(LMB_ERROR_FORMAT, "grid " + validity.getName() + " holds no probes and no box of them");
    }
    return box;
}

lmb_lattice read_lattice(const LevelGrids &level)
{
    const CoordBBox box = read_box(level);
    lmb_lattice lattice{};
    lattice.spacing = read_spacing(*level.set[0].validity);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t length = static_cast<int64_t>(box.max()[axis]) - box.min()[axis] + 1;
        lattice.min[axis] = box.min()[axis];
        lattice.size[axis] = length > INT32_MAX ? 0 : static_cast<int32_t>(length); /* 0 is refused later */
    }
    return lattice;
}

// -------------------------------------------------------------------------------------------- placing probes

[[noreturn]] void fail_topology(const openvdb::GridBase &grid, const SetGrids &set)
{
    fail(LMB_ERROR_FORMAT,
         "grids " + grid.getName() + " and " + set.validity->getName() + " differ in spacing or active voxels");
}

// Before anything is made of a file's voxels, of which a few bytes may claim millions.
void check_voxel_counts(const Contents &contents)
{
    for (const LevelGrids &level : contents.level) {
        for (const SetGrids &set : level.set) {
            const openvdb::Index64 voxels = set.validity->activeVoxelCount();
            for (const auto &coefficient : set.coefficient) {
                if (coefficient->activeVoxelCount() != voxels) {
                    fail_topology(*coefficient, set);
                }
            }
        }
    }
}

// Active voxels, x fastest; tiles count as the voxels that they cover.
std::vector<Coord> active_voxels(const FloatGrid &validity)
{
    std::vector<Coord> points;
    for (auto value = validity.tree().cbeginValueOn(); value; ++value) {
        CoordBBox covered;
        value.getBoundingBox(covered);
        for (auto point = covered.begin(); point; ++point) {
            points.push_back(*point);
        }
    }
    std::sort(points.begin(), points.end(), [](const Coord &a, const Coord &b) {
        return a.z() != b.z() ? a.z() < b.z() : a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
    });
    return points;
}

static_assert(sizeof(Coord) == sizeof(int32_t[3]), "points are coordinates");
using Points = const int32_t (*)[3];

void corner_point(const lmb_vdb_cell &cell, int corner, int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = static_cast<int32_t>(static_cast<uint32_t>(cell.point[axis]) + (corner >> axis & 1));
    }
}

// A level's ghosts as numbers of their voxels: in the order in which cut cells name them, then those that none names.
std::vector<size_t> order_ghosts(const LevelGrids &level)
{
    const std::vector<Coord> &voxel = level.set[1].voxel;
    LayerIndex index;
    for (size_t i = 0; i < voxel.size(); ++i) {
        const GhostPlace place = ghost_place(voxel[i].asPointer());
        index.add(place.layer, place.point, static_cast<int32_t>(i));
    }
    std::vector<bool> is_listed(voxel.size());
    std::vector<size_t> ghosts;
    const auto list = [&](size_t number) {
        if (!is_listed[number]) {
            is_listed[number] = true;
            ghosts.push_back(number);
        }
    };
    for_each_cut_cell(level, [&](const lmb_vdb_cell &cell) {
        for (uint32_t k = 0; k < 8 * cell.region_count; ++k) {
            int32_t point[3];
            corner_point(cell, static_cast<int>(k % 8), point);
            const int32_t found = index.find(cell.layer[k / 8][k % 8], point);
            if (found >= 0) {
                list(static_cast<size_t>(found));
            }
        }
    });
    for (size_t i = 0; i < voxel.size(); ++i) {
        list(i);
    }
    return ghosts;
}

void add_ghosts(lmb_probes &probes, LevelGrids &level)
{
    SetGrids &set = level.set[1];
    if (read_spacing(*set.validity) * kGhostsAlong != read_spacing(*level.set[0].validity)) {
        fail(LMB_ERROR_FORMAT, "grid " + set.validity->getName() + " has not a quarter of the spacing of its level");
    }
    const std::vector<size_t> ghosts = order_ghosts(level);
    std::vector<Coord> points;
    for (const size_t ghost : ghosts) {
        points.push_back(ghost_point(set.voxel[ghost]));
    }
    int32_t next = 0;
    check(lmb_probes_add_ghosts(&probes, set.set.level, reinterpret_cast<Points>(points.data()),
                                static_cast<int32_t>(points.size()), &next),
          "the ghosts are out of range");
    for (const size_t ghost : ghosts) {
        set.probe[ghost] = next++;
    }
}

// Cuts the cells that still have all of their probes; others are what their level's probes make of them.
void cut_cells(lmb_probes &probes, uint32_t number, const LevelGrids &level)
{
    if (level.cut_cells.empty()) {
        return;
    }
    LayerIndex index;
    for (const SetGrids &set : level.set) {
        for (size_t i = 0; i < set.voxel.size(); ++i) {
            GhostPlace place{{set.voxel[i].x(), set.voxel[i].y(), set.voxel[i].z()}, 0};
            place = set.set.ghosts ? ghost_place(place.point) : place;
            index.add(place.layer, place.point, set.probe[i]);
        }
    }
    for_each_cut_cell(level, [&](const lmb_vdb_cell &cell) {
        int32_t corner[LMB_CELL_REGIONS_MOST][8];
        bool whole = true;
        for (uint32_t k = 0; k < 8 * cell.region_count; ++k) {
            int32_t point[3];
            corner_point(cell, static_cast<int>(k % 8), point);
            corner[k / 8][k % 8] = index.find(cell.layer[k / 8][k % 8], point);
            whole = whole && corner[k / 8][k % 8] >= 0;
        }
        if (whole) {
            check(lmb_probes_cut(&probes, number, cell.point, cell.plane, cell.plane_count, corner, cell.region_count),
                  "a cut cell has planes or regions that it cannot have, or is there twice");
        }
    });
}

void add_level(lmb_probes &probes, float spacing, LevelGrids &level)
{
    const lmb_lattice lattice = read_lattice(level);
    if (lattice.spacing != spacing) {
        fail(LMB_ERROR_FORMAT,
             "grid " + level.set[0].validity->getName() + " has not twice the spacing of the level before it");
    }
    SetGrids &own = level.set[0];
    for (size_t i = 0; i < own.probe.size(); ++i) {
        own.probe[i] = probes.count + static_cast<int32_t>(i);
    }
    check(lmb_probes_add_level(&probes, &lattice, reinterpret_cast<Points>(own.voxel.data()),
                               static_cast<int32_t>(own.voxel.size())),
          "the box of probes, or the spacing, is out of range");
}

void find_voxels(Contents &contents)
{
    openvdb::Index64 voxels = 0;
    for (const LevelGrids &level : contents.level) {
        for (const SetGrids &set : level.set) {
            voxels += set.validity->tree().activeVoxelCount();
        }
    }
    if (voxels > kMostProbes) {
        fail(LMB_ERROR_FORMAT, "holds too many probes");
    }
    for (LevelGrids &level : contents.level) {
        for (SetGrids &set : level.set) {
            set.voxel = active_voxels(*set.validity);
            set.probe.resize(set.voxel.size());
        }
    }
}

// Dark probes and ghosts, one at every active voxel, and the cut cells between them.
ProbesHandle make_probes(Contents &contents)
{
    find_voxels(contents);
    lmb_probes *created = nullptr;
    check(lmb_probes_create(&created), "out of memory");
    ProbesHandle probes(created);
    float spacing = read_spacing(*contents.level[0].set[0].validity);
    for (LevelGrids &level : contents.level) {
        add_level(*created, spacing, level);
        spacing *= 2.0f;
    }
    for (uint32_t number = 0; number < contents.level.size(); ++number) {
        LevelGrids &level = contents.level[number];
        if (level.set.size() > 1) {
            add_ghosts(*created, level);
        }
        cut_cells(*created, number, level);
    }
    return probes;
}

// ---------------------------------------------------------------------------------------------------- values

void read_coefficient(const SetGrids &set, int i, lmb_probes &probes)
{
    const Vec3SGrid &coefficient = *set.coefficient[i];
    if (read_spacing(coefficient) != read_spacing(*set.validity)) {
        fail_topology(coefficient, set);
    }
    check_version(coefficient);
    const float scale = read_scale(coefficient);
    const Vec3SGrid::ConstAccessor accessor = coefficient.getConstAccessor();
    for (size_t k = 0; k < set.voxel.size(); ++k) {
        openvdb::Vec3s value;
        if (!accessor.probeValue(set.voxel[k], value)) {
            fail_topology(coefficient, set);
        }
        for (int channel = 0; channel < 3; ++channel) {
            probes.radiance[0][set.probe[k]].channel[channel].c[i] = value[channel] * scale;
        }
    }
}

void read_set(const SetGrids &set, lmb_probes &probes)
{
    const FloatGrid::ConstAccessor accessor = set.validity->getConstAccessor();
    for (size_t k = 0; k < set.voxel.size(); ++k) {
        probes.validity[set.probe[k]] = accessor.getValue(set.voxel[k]);
    }
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        read_coefficient(set, i, probes);
    }
    for (uint32_t key = 0; key < set.visibility.size(); ++key) {
        const FloatGrid &visibility = *set.visibility[key];
        const FloatGrid::ConstAccessor seen = visibility.getConstAccessor();
        for (size_t k = 0; k < set.voxel.size(); ++k) {
            if (!seen.probeValue(set.voxel[k], probes.key_visibility[set.probe[k]][key])) {
                fail_topology(visibility, set);
            }
        }
    }
}

// What the key lights are.
void read_key_lights(const SetGrids &finest, lmb_probes &probes)
{
    const FloatGrid &validity = *finest.validity;
    for (uint32_t key = 0; key < finest.visibility.size(); ++key) {
        const auto direction = validity.getMetadata<openvdb::Vec3SMetadata>(key_direction_name(key));
        const auto irradiance = validity.getMetadata<openvdb::Vec3SMetadata>(key_irradiance_name(key));
        if (!direction || !irradiance) {
            fail(LMB_ERROR_FORMAT, "grid validity has no usable " + key_irradiance_name(key));
        }
        const openvdb::Vec3s to_light = direction->value(), light = irradiance->value();
        probes.key_light[key] = {{to_light[0], to_light[1], to_light[2]}, {{light[0], light[1], light[2]}}};
        probes.key_light_count = key + 1;
    }
}

ProbesHandle read_probes(Contents &contents)
{
    check_voxel_counts(contents);
    ProbesHandle probes = make_probes(contents);
    read_key_lights(contents.level[0].set[0], *probes);
    for (const LevelGrids &level : contents.level) {
        for (const SetGrids &set : level.set) {
            read_set(set, *probes);
        }
    }
    for (const LocalGrids &local : contents.local) {
        read_local(local, *probes);
    }
    lmb_error error;
    if (lmb_probes_validate(probes.get(), &error) != LMB_OK) {
        fail(LMB_ERROR_FORMAT, error.message);
    }
    return probes;
}

// Empty when another tool has dropped it.
TextHandle read_text(const openvdb::MetaMap &metadata, const char *name)
{
    const openvdb::StringMetadata::ConstPtr text = metadata.getMetadata<openvdb::StringMetadata>(name);
    TextHandle copy(strdup(text ? text->value().c_str() : ""));
    if (!copy) {
        throw std::bad_alloc();
    }
    return copy;
}

} // namespace

File read_file(const std::string &path)
{
    openvdb::initialize();
    Contents contents = read_contents(path);
    ProbesHandle probes = read_probes(contents);
    TextHandle settings = read_text(*contents.metadata, "lambent_settings");
    TextHandle scene_hash = read_text(*contents.metadata, "lambent_scene_hash");
    return {probes.release(), settings.release(), scene_hash.release()};
}

} // namespace lmb_vdb
