// What the C++ files behind lambent/vdb.h share: failures, names, and layers of probes.
#ifndef LAMBENT_VDB_INTERNAL_HH
#define LAMBENT_VDB_INTERNAL_HH

#include <lambent/vdb.h>

#include <cstdint>
#include <string>
#include <vector>

namespace lmb_vdb {

constexpr int kFormatVersion = 3;

// More layers of ghosts than a corner can name.
constexpr uint32_t kMostLayers = 255;

// A failure with its result code, on its way to the C entry.
struct Failure {
    lmb_result result;
    std::string message;
};

[[noreturn]] inline void fail(lmb_result result, const std::string &message)
{
    throw Failure{result, message};
}

// Probes at points of a level, each point once: those of the level itself are its layer 0, and its ghosts fill as many
// more as the point with most of them has.
struct Layer {
    uint32_t level;
    uint32_t number;
};

// What ends the names of its grids: nothing for the finest level's probes.
inline std::string suffix(const Layer &layer)
{
    return (layer.level > 0 ? "_level_" + std::to_string(layer.level) : std::string()) +
           (layer.number > 0 ? "_ghost_" + std::to_string(layer.number) : std::string());
}

inline std::string coefficient_name(int i, const Layer &layer)
{
    return "sh_" + std::to_string(i) + suffix(layer);
}

inline std::string validity_name(const Layer &layer)
{
    return "validity" + suffix(layer);
}

inline std::string visibility_name(uint32_t key, const Layer &layer)
{
    return "key_visibility_" + std::to_string(key) + suffix(layer);
}

inline std::string key_direction_name(uint32_t key)
{
    return "lambent_key_direction_" + std::to_string(key);
}

inline std::string key_irradiance_name(uint32_t key)
{
    return "lambent_key_irradiance_" + std::to_string(key);
}

// The probes of each layer of a level, by their points.
class LayerIndex {
  public:
    LayerIndex() = default;
    LayerIndex(const LayerIndex &) = delete;
    LayerIndex &operator=(const LayerIndex &) = delete;
    ~LayerIndex();

    void add(uint32_t layer, const int32_t point[3], int32_t probe);
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

} // namespace lmb_vdb

#endif
