// The only C++ file of volume/: OpenVDB behind the C contract of lambent/vdb.h. Every entry catches everything.
#include <lambent/vdb.h>

#include "volume_internal.h"

#include <lambent/file.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <string>
#include <unistd.h>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>

namespace {

// Tiles of a few bytes may stand for any number.
constexpr int64_t kMostProbes = int64_t(1) << 28;

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

constexpr int kFormatVersion = 1;         // of files without key lights
constexpr int kFormatVersionWithKeys = 2; // whose radiance is not all of the light
constexpr const char *kBasis = "00 1-1 10 11 2-2 2-1 20 21 22";

// Magic, file version, library version and one flag come before the UUID.
constexpr std::streamoff kUuidOffset = 21;
constexpr size_t kUuidLength = 36;

// A failure with its result code, on its way to the C entry.
struct Failure {
    lmb_result result;
    std::string message;
};

[[noreturn]] void fail(lmb_result result, const std::string &message)
{
    throw Failure{result, message};
}

std::string coefficient_name(int i)
{
    return "sh_" + std::to_string(i);
}

std::string visibility_name(uint32_t key)
{
    return "key_visibility_" + std::to_string(key);
}

std::string key_direction_name(uint32_t key)
{
    return "lambent_key_direction_" + std::to_string(key);
}

std::string key_irradiance_name(uint32_t key)
{
    return "lambent_key_irradiance_" + std::to_string(key);
}

// ---------------------------------------------------------------------------------------------- content hash

// A UUID of version 8 (free form, RFC 9562) from the file's bytes outside the UUID: two 64-bit FNV-1a hashes with
// different seeds. OpenVDB's own are random and of version 4.
std::string content_uuid(std::istream &file)
{
    uint64_t hash[2] = {LMB_HASH_SEED, lmb_hash(LMB_HASH_SEED, "lambent", 7)};
    std::vector<char> buffer(1 << 16);
    const auto add = [&](size_t wanted) {
        file.read(buffer.data(), static_cast<std::streamsize>(wanted));
        const size_t got = static_cast<size_t>(file.gcount());
        for (uint64_t &h : hash) {
            h = lmb_hash(h, buffer.data(), got);
        }
        return got == wanted;
    };
    file.seekg(0);
    if (add(static_cast<size_t>(kUuidOffset))) {
        file.seekg(kUuidOffset + static_cast<std::streamoff>(kUuidLength));
        while (add(buffer.size())) {
        }
    }
    const uint64_t high = (hash[0] & ~UINT64_C(0xf000)) | UINT64_C(0x8000);
    const uint64_t low = (hash[1] & ~(UINT64_C(3) << 62)) | UINT64_C(2) << 62;
    char text[kUuidLength + 1];
    std::snprintf(text, sizeof text, "%08x-%04x-%04x-%04x-%012llx", static_cast<unsigned>(high >> 32),
                  static_cast<unsigned>(high >> 16 & 0xffff), static_cast<unsigned>(high & 0xffff),
                  static_cast<unsigned>(low >> 48), static_cast<unsigned long long>(low & UINT64_C(0xffffffffffff)));
    return text;
}

void overwrite_uuid(const std::string &path)
{
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const std::string uuid = content_uuid(file);
    if (file.bad() || !file.eof()) {
        fail(LMB_ERROR_WRITE, std::string("cannot write: ") + std::strerror(errno));
    }
    file.clear();
    file.seekp(kUuidOffset);
    file.write(uuid.data(), static_cast<std::streamsize>(uuid.size()));
    file.close();
    if (!file) {
        fail(LMB_ERROR_WRITE, std::string("cannot write: ") + std::strerror(errno));
    }
}

// A file that still carries its content hash must match it. One that another tool saved has a UUID of that tool's.
void check_uuid(std::ifstream &file)
{
    std::string stored(kUuidLength, '\0');
    file.seekg(kUuidOffset);
    file.read(&stored[0], static_cast<std::streamsize>(kUuidLength));
    if (!file) {
        fail(LMB_ERROR_FORMAT, "the file is cut short in its header");
    }
    const bool is_ours = stored[14] == '8';
    if (is_ours && stored != content_uuid(file)) {
        fail(LMB_ERROR_FORMAT, "damaged or cut short: the contents do not match their hash");
    }
    file.clear();
}

// ---------------------------------------------------------------------------------------------- writing

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

// What a reader needs to interpret the values; on the file and on every grid, as editors keep only the latter.
void describe(openvdb::MetaMap &target, const lmb_probes &probes, float scale)
{
    const lmb_lattice &lattice = probes.level[0].lattice;
    const bool has_keys = probes.key_light_count > 0;
    target.insertMeta("lambent_version", openvdb::Int32Metadata(has_keys ? kFormatVersionWithKeys : kFormatVersion));
    target.insertMeta("lambent_scale", openvdb::FloatMetadata(scale));
    target.insertMeta("lambent_spacing", openvdb::FloatMetadata(lattice.spacing));
    target.insertMeta("lambent_min",
                      openvdb::Vec3IMetadata(openvdb::Vec3i(lattice.min[0], lattice.min[1], lattice.min[2])));
    target.insertMeta("lambent_size",
                      openvdb::Vec3IMetadata(openvdb::Vec3i(lattice.size[0], lattice.size[1], lattice.size[2])));
    target.insertMeta("lambent_convention",
                      openvdb::StringMetadata("real orthonormal spherical harmonics with Condon-Shortley signs; "
                                              "right-handed world, +Y up"));
    target.insertMeta("lambent_basis", openvdb::StringMetadata(kBasis));
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

FloatGrid::Ptr make_validity_grid(const lmb_probes &probes)
{
    FloatGrid::Ptr validity = FloatGrid::create(0.0f);
    validity->setName("validity");
    validity->setTransform(
        openvdb::math::Transform::createLinearTransform(static_cast<double>(probes.level[0].lattice.spacing)));
    FloatGrid::Accessor accessor = validity->getAccessor();
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
        accessor.setValue(Coord(probes.point[probe]), probes.validity[probe]);
    }
    return validity;
}

Vec3SGrid::Ptr make_coefficient_grid(const lmb_probes &probes, const FloatGrid &validity, int i, float scale)
{
    Vec3SGrid::Ptr coefficient = Vec3SGrid::create(
        std::make_shared<openvdb::Vec3STree>(validity.tree(), openvdb::Vec3s(0.0f), openvdb::TopologyCopy()));
    coefficient->setName(coefficient_name(i));
    coefficient->setTransform(validity.transform().copy());
    coefficient->setSaveFloatAsHalf(true);
    coefficient->setVectorType(openvdb::VEC_INVARIANT);
    Vec3SGrid::Accessor accessor = coefficient->getAccessor();
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
        const lmb_sh3 *const channel = probes.radiance[0][probe].channel;
        accessor.setValueOnly(Coord(probes.point[probe]),
                              openvdb::Vec3s(channel[0].c[i], channel[1].c[i], channel[2].c[i]) / scale);
    }
    return coefficient;
}

FloatGrid::Ptr make_visibility_grid(const lmb_probes &probes, const FloatGrid &validity, uint32_t key)
{
    FloatGrid::Ptr visibility =
        FloatGrid::create(std::make_shared<openvdb::FloatTree>(validity.tree(), 0.0f, openvdb::TopologyCopy()));
    visibility->setName(visibility_name(key));
    visibility->setTransform(validity.transform().copy());
    FloatGrid::Accessor accessor = visibility->getAccessor();
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
        accessor.setValueOnly(Coord(probes.point[probe]), probes.key_visibility[probe][key]);
    }
    return visibility;
}

void check_magnitudes(const lmb_probes &probes, float scale)
{
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
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

void write_temporary(const std::string &path, const lmb_probes &probes, const lmb_vdb_metadata &metadata)
{
    const float scale = lmb_probes_scale(&probes);
    check_magnitudes(probes, scale);
    openvdb::initialize();
    const FloatGrid::Ptr validity = make_validity_grid(probes);
    openvdb::GridPtrVec grids;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        grids.push_back(make_coefficient_grid(probes, *validity, i, scale));
    }
    grids.push_back(validity);
    for (uint32_t key = 0; key < probes.key_light_count; ++key) {
        grids.push_back(make_visibility_grid(probes, *validity, key));
    }
    for (const openvdb::GridBase::Ptr &each : grids) {
        describe(*each, probes, scale);
        each->setCreator("Lambent");
    }
    openvdb::MetaMap file_metadata;
    describe(file_metadata, probes, scale);
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

// ---------------------------------------------------------------------------------------------- reading

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

// What a file holds, before it becomes lmb_probes.
struct Contents {
    Vec3SGrid::Ptr coefficients[LMB_SH3_COUNT];
    FloatGrid::Ptr validity;
    std::vector<FloatGrid::Ptr> visibility; // of key lights
    openvdb::MetaMap::Ptr metadata;
};

template <typename GridType> typename GridType::Ptr find_grid(const openvdb::GridPtrVec &grids, const std::string &name)
{
    for (const openvdb::GridBase::Ptr &grid : grids) {
        if (grid && grid->getName() == name) {
            const typename GridType::Ptr typed = openvdb::gridPtrCast<GridType>(grid);
            if (!typed) {
                fail(LMB_ERROR_FORMAT,
                     "grid " + name + " is of type " + grid->type() + ", not " + GridType::gridType());
            }
            return typed;
        }
    }
    fail(LMB_ERROR_FORMAT, "has no grid " + name);
}

// The metadata alone tells whether it is worth reading the rest. The version stands on every grid.
void check_version(const openvdb::MetaMap &grid)
{
    const openvdb::Int32Metadata::ConstPtr version = grid.getMetadata<openvdb::Int32Metadata>("lambent_version");
    if (!version) {
        fail(LMB_ERROR_FORMAT, "not written by Lambent: grid sh_0 has no lambent_version, so its units and signs are "
                               "unknown");
    }
    if (version->value() > kFormatVersionWithKeys) {
        fail(LMB_ERROR_VERSION, "format version " + std::to_string(version->value()) + " is newer than " +
                                    std::to_string(kFormatVersionWithKeys) + ", which this Lambent reads");
    }
    if (version->value() < 1) {
        fail(LMB_ERROR_FORMAT, "format version " + std::to_string(version->value()) + " does not exist");
    }
}

// Those of the grid that probes are known by.
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

Contents read_contents(const std::string &path)
{
    std::ifstream stream(path, std::ios::binary);
    char magic[4] = {};
    stream.read(magic, sizeof magic);
    if (!stream || std::memcmp(magic, " BDV", sizeof magic) != 0) {
        fail(LMB_ERROR_FORMAT, "not a .vdb file");
    }
    check_uuid(stream);
    check_descriptors(path);

    // OpenVDB does not look whether a read succeeded: the stream throws instead.
    stream.seekg(0);
    stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    Contents contents;
    try {
        openvdb::io::Stream archive(stream, false);
        const openvdb::GridPtrVecPtr grids = archive.getGrids();
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            contents.coefficients[i] = find_grid<Vec3SGrid>(*grids, coefficient_name(i));
        }
        contents.validity = find_grid<FloatGrid>(*grids, "validity");
        for (uint32_t key = 0; key < key_light_count(*contents.validity); ++key) {
            contents.visibility.push_back(find_grid<FloatGrid>(*grids, visibility_name(key)));
        }
        contents.metadata = archive.getMetadata();
    } catch (const std::ios::failure &) {
        fail(LMB_ERROR_FORMAT, "the file is cut short");
    }
    return contents;
}

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

float read_scale(const openvdb::GridBase &grid)
{
    const openvdb::FloatMetadata::ConstPtr scale = grid.getMetadata<openvdb::FloatMetadata>("lambent_scale");
    if (!scale || !std::isfinite(scale->value()) || !(scale->value() > 0.0f)) {
        fail(LMB_ERROR_FORMAT, "grid " + grid.getName() + " has no usable lambent_scale");
    }
    return scale->value();
}

// The box that was written, where it still holds all probes; else the box around them.
CoordBBox read_box(const Contents &contents)
{
    CoordBBox box;
    const openvdb::MetaMap &metadata = *contents.validity;
    const auto min = metadata.getMetadata<openvdb::Vec3IMetadata>("lambent_min");
    const auto size = metadata.getMetadata<openvdb::Vec3IMetadata>("lambent_size");
    const bool has_probes = contents.validity->tree().evalActiveVoxelBoundingBox(box);
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
        fail(LMB_ERROR_FORMAT, "holds no probes and no box of them");
    }
    return box;
}

void check(lmb_result result, const char *what)
{
    if (result != LMB_OK) {
        fail(result == LMB_ERROR_MEMORY ? result : LMB_ERROR_FORMAT, what);
    }
}

// Dark probes of the file's box, one at every active voxel; tiles count as the voxels that they cover.
ProbesHandle make_probes(const Contents &contents)
{
    const CoordBBox box = read_box(contents);
    lmb_lattice lattice{};
    lattice.spacing = read_spacing(*contents.validity);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t length = static_cast<int64_t>(box.max()[axis]) - box.min()[axis] + 1;
        lattice.min[axis] = box.min()[axis];
        lattice.size[axis] = length > INT32_MAX ? 0 : static_cast<int32_t>(length); /* 0 is refused below */
    }
    if (contents.validity->tree().activeVoxelCount() > static_cast<openvdb::Index64>(kMostProbes)) {
        fail(LMB_ERROR_FORMAT, "holds too many probes");
    }
    std::vector<Coord> points;
    for (auto value = contents.validity->tree().cbeginValueOn(); value; ++value) {
        CoordBBox covered;
        value.getBoundingBox(covered);
        for (auto point = covered.begin(); point; ++point) {
            points.push_back(*point);
        }
    }
    // The order in which they were placed: x fastest.
    std::sort(points.begin(), points.end(), [](const Coord &a, const Coord &b) {
        return a.z() != b.z() ? a.z() < b.z() : a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
    });
    static_assert(sizeof(Coord) == sizeof(int32_t[3]), "points are coordinates");
    lmb_probes *created = nullptr;
    check(lmb_probes_create(&created), "out of memory");
    ProbesHandle probes(created);
    check(lmb_probes_add_level(created, &lattice, reinterpret_cast<const int32_t(*)[3]>(points.data()),
                               static_cast<int32_t>(points.size())),
          "the box of probes, or the spacing, is out of range");
    return probes;
}

void read_coefficient(const Vec3SGrid &coefficient, int i, lmb_probes &probes)
{
    if (read_spacing(coefficient) != probes.level[0].lattice.spacing ||
        coefficient.activeVoxelCount() != static_cast<openvdb::Index64>(probes.count)) {
        fail(LMB_ERROR_FORMAT, "grids " + coefficient.getName() + " and validity differ in spacing or active voxels");
    }
    check_version(coefficient);
    const float scale = read_scale(coefficient);
    const Vec3SGrid::ConstAccessor accessor = coefficient.getConstAccessor();
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
        openvdb::Vec3s value;
        if (!accessor.probeValue(Coord(probes.point[probe]), value)) {
            fail(LMB_ERROR_FORMAT, "grids " + coefficient.getName() + " and validity differ in active voxels");
        }
        for (int channel = 0; channel < 3; ++channel) {
            probes.radiance[0][probe].channel[channel].c[i] = value[channel] * scale;
        }
    }
}

// Visibility of a key light, and what the light is.
void read_key_light(const Contents &contents, uint32_t key, lmb_probes &probes)
{
    const FloatGrid &visibility = *contents.visibility[key];
    const auto direction = contents.validity->getMetadata<openvdb::Vec3SMetadata>(key_direction_name(key));
    const auto irradiance = contents.validity->getMetadata<openvdb::Vec3SMetadata>(key_irradiance_name(key));
    if (!direction || !irradiance) {
        fail(LMB_ERROR_FORMAT, "grid validity has no usable " + key_irradiance_name(key));
    }
    const openvdb::Vec3s to_light = direction->value(), light = irradiance->value();
    probes.key_light[key] = {{to_light[0], to_light[1], to_light[2]}, {{light[0], light[1], light[2]}}};
    probes.key_light_count = key + 1;
    const FloatGrid::ConstAccessor accessor = visibility.getConstAccessor();
    for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
        float seen = 0.0f;
        if (!accessor.probeValue(Coord(probes.point[probe]), seen)) {
            fail(LMB_ERROR_FORMAT, "grids " + visibility.getName() + " and validity differ in active voxels");
        }
        probes.key_visibility[probe][key] = seen;
    }
}

ProbesHandle read_probes(const Contents &contents)
{
    ProbesHandle probes = make_probes(contents);
    const FloatGrid::ConstAccessor accessor = contents.validity->getConstAccessor();
    for (int32_t probe = 0; probe < probes->count - probes->ghost_count; ++probe) {
        probes->validity[probe] = accessor.getValue(Coord(probes->point[probe]));
    }
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        read_coefficient(*contents.coefficients[i], i, *probes);
    }
    for (uint32_t key = 0; key < contents.visibility.size(); ++key) {
        read_key_light(contents, key, *probes);
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

// Runs `work`, turning whatever it throws into a result and one line. OpenVDB's own exceptions count as `otherwise`.
template <typename Work> lmb_result guarded(const char *path, lmb_result otherwise, lmb_error *error, const Work &work)
{
    try {
        work();
        return LMB_OK;
    } catch (const Failure &failure) {
        return lmb_error_set(error, failure.result, "%s: %s", path, failure.message.c_str());
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    } catch (const std::exception &exception) {
        return lmb_error_set(error, otherwise, "%s: OpenVDB: %s", path, exception.what());
    } catch (...) {
        return lmb_error_set(error, otherwise, "%s: OpenVDB failed without saying why", path);
    }
}

} // namespace

lmb_result lmb_vdb_write(const char *path, const lmb_probes *probes, const lmb_vdb_metadata *metadata, lmb_error *error)
{
    assert(path && probes && metadata && metadata->settings && metadata->scene_hash);
    if (probes->level_count != 1 || probes->set_count != 1) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: the format holds one level and one set of lights", path);
    }
    if (!lmb_probes_key_lights_are_sane(probes)) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: a key light has no direction or no irradiance", path);
    }
    if (lmb_lattice_is_turned(&probes->level[0].lattice)) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: the format holds no lattice that is turned", path);
    }
    char *const temporary = lmb_file_temporary_path(path);
    if (!temporary) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    lmb_result result = guarded(path, LMB_ERROR_WRITE, error, [&] { write_temporary(temporary, *probes, *metadata); });
    if (result == LMB_OK) {
        result = lmb_file_commit(temporary, path, error);
    } else {
        unlink(temporary);
    }
    free(temporary);
    return result;
}

lmb_result lmb_vdb_read(const char *path, lmb_probes **probes, char **settings, char **scene_hash, lmb_error *error)
{
    assert(path && probes);
    std::FILE *const opened = std::fopen(path, "rb");
    if (!opened || std::fgetc(opened) == EOF) {
        const bool is_empty = opened && !std::ferror(opened);
        const char *const reason = is_empty ? "the file is empty" : std::strerror(errno);
        const lmb_result result = is_empty ? LMB_ERROR_FORMAT : LMB_ERROR_IO;
        lmb_error_set(error, result, is_empty ? "%s: %s" : "%s: cannot read: %s", path, reason);
        if (opened) {
            std::fclose(opened);
        }
        return result;
    }
    std::fclose(opened);
    return guarded(path, LMB_ERROR_FORMAT, error, [&] {
        openvdb::initialize();
        const Contents contents = read_contents(path);
        ProbesHandle read = read_probes(contents);
        TextHandle settings_text = read_text(*contents.metadata, "lambent_settings");
        TextHandle hash_text = read_text(*contents.metadata, "lambent_scene_hash");
        *probes = read.release();
        if (settings) {
            *settings = settings_text.release();
        }
        if (scene_hash) {
            *scene_hash = hash_text.release();
        }
    });
}
