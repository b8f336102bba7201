// What the C++ files behind lambent/vdb.h share: failures, names, and layers of probes.
#ifndef LAMBENT_VDB_INTERNAL_HH
#define LAMBENT_VDB_INTERNAL_HH

#include <lambent/vdb.h>

#include <cstdint>
#include <string>
#include <vector>

namespace lmb_vdb {

constexpr int kFormatVersion = 3;

// A failure with its result code, on its way to the C entry.
struct Failure {
    lmb_result result;
    std::string message;
};

[[noreturn]] inline void fail(lmb_result result, const std::string &message)
{
    throw Failure{result, message};
}

// Grids that share one topology: those of a level's probes, or of its ghosts.
struct GridSet {
    uint32_t level;
    bool ghosts;
};

// What ends the names of its grids: nothing for the finest level's probes.
inline std::string suffix(const GridSet &set)
{
    return (set.level > 0 ? "_level_" + std::to_string(set.level) : std::string()) + (set.ghosts ? "_ghosts" : "");
}

inline std::string coefficient_name(int i, const GridSet &set)
{
    return "sh_" + std::to_string(i) + suffix(set);
}

inline std::string validity_name(const GridSet &set)
{
    return "validity" + suffix(set);
}

inline std::string visibility_name(uint32_t key, const GridSet &set)
{
    return "key_visibility_" + std::to_string(key) + suffix(set);
}

inline std::string key_direction_name(uint32_t key)
{
    return "lambent_key_direction_" + std::to_string(key);
}

inline std::string key_irradiance_name(uint32_t key)
{
    return "lambent_key_irradiance_" + std::to_string(key);
}

// A level's probes by their points are its layer 0; of each point the first, second, ... ghost is in layer 1, 2, ...
//
// Ghosts are voxels of a quarter of the spacing, 4 x 4 x 4 about each point: layer 1 + a + 4 b + 16 c of point p is
// voxel 4 p + (a, b, c), each of these two bits a signed number.
constexpr uint32_t kMostLayers = 64;
constexpr int32_t kGhostsAlong = 4;

// Points farther out have no ghosts: their voxels would not be int32_t.
constexpr int32_t kFarthestGhost = INT32_MAX / kGhostsAlong - 1;

struct GhostPlace {
    int32_t point[3];
    uint32_t layer;
};

inline int32_t ghost_voxel(const GhostPlace &place, int axis)
{
    const int32_t bits = static_cast<int32_t>((place.layer - 1) >> 2 * axis & 3u);
    return kGhostsAlong * place.point[axis] + (bits >= 2 ? bits - kGhostsAlong : bits);
}

inline GhostPlace ghost_place(const int32_t voxel[3])
{
    GhostPlace place{{}, 1};
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t bits = static_cast<int32_t>(static_cast<uint32_t>(voxel[axis]) & 3u);
        const int64_t below = bits >= 2 ? bits - kGhostsAlong : bits;
        place.point[axis] = static_cast<int32_t>((voxel[axis] - below) / kGhostsAlong);
        place.layer += static_cast<uint32_t>(bits) << 2 * axis;
    }
    return place;
}

// What is in each layer of a level, by points.
class LayerIndex {
  public:
    LayerIndex() = default;
    LayerIndex(const LayerIndex &) = delete;
    LayerIndex &operator=(const LayerIndex &) = delete;
    ~LayerIndex();

    void add(uint32_t layer, const int32_t point[3], int32_t number);
    int32_t find(uint32_t layer, const int32_t point[3]) const; // or -1

  private:
    std::vector<lmb_probe_index> index_;
};

// Writes a finished file at `path`, with its content hash. `probes` are such as the format holds.
void write_file(const std::string &path, const lmb_probes &probes, const lmb_vdb_metadata &metadata);

// What is read, in C's hands: the caller destroys and frees.
struct File {
    lmb_probes *probes;
    char *settings, *scene_hash; // malloc'ed
};
File read_file(const std::string &path);

// ------------------------------------------------------------------------------------------------ content hash

// Puts a UUID made of the file's other bytes in its place.
void overwrite_uuid(const std::string &path);

// A file that still carries its content hash must match it. One that another tool saved has a UUID of that tool's.
void check_uuid(const std::string &path);

// Letters of a UUID in the header.
constexpr size_t kUuidLength = 36;

// Whatever the file says of lengths and counts is so, and OpenVDB may read it.
void check_structure(const std::string &path);

} // namespace lmb_vdb

#endif
