// The C contract of lambent/vdb.h over the C++ files of OpenVDB's side. Every entry catches everything.
#include <lambent/vdb.h>

#include "vdb_internal.hh"
#include "volume_internal.h"

#include <lambent/file.h>

#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <unistd.h>

namespace lmb_vdb {

LayerIndex::~LayerIndex()
{
    for (lmb_probe_index &index : index_) {
        lmb_probe_index_free(&index);
    }
}

void LayerIndex::add(uint32_t layer, const int32_t point[3], int32_t number)
{
    if (layer >= index_.size()) {
        index_.resize(layer + 1, lmb_probe_index{});
    }
    if (lmb_probe_index_add(&index_[layer], point, number) == LMB_ERROR_MEMORY) {
        throw std::bad_alloc();
    }
}

int32_t LayerIndex::find(uint32_t layer, const int32_t point[3]) const
{
    return layer < index_.size() ? lmb_probe_index_find(&index_[layer], point) : -1;
}

} // namespace lmb_vdb

namespace {

// Runs `work`, turning whatever it throws into a result and one line. OpenVDB's own exceptions count as `otherwise`.
template <typename Work> lmb_result guarded(const char *path, lmb_result otherwise, lmb_error *error, const Work &work)
{
    try {
        work();
        return LMB_OK;
    } catch (const lmb_vdb::Failure &failure) {
        return lmb_error_set(error, failure.result, "%s: %s", path, failure.message.c_str());
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    } catch (const std::exception &exception) {
        return lmb_error_set(error, otherwise, "%s: OpenVDB: %s", path, exception.what());
    } catch (...) {
        return lmb_error_set(error, otherwise, "%s: OpenVDB failed without saying why", path);
    }
}

// What of the probes the format does not hold, or NULL.
const char *refusal(const lmb_probes &probes)
{
    if (probes.level_count < 1 || probes.set_count != 1) {
        return "the format holds at least one level, and one set of lights";
    }
    if (!lmb_probes_key_lights_are_sane(&probes)) {
        return "a key light has no direction or no irradiance";
    }
    float spacing = probes.level[0].lattice.spacing;
    for (uint32_t level = 0; level < probes.level_count; ++level, spacing *= 2.0f) {
        if (lmb_lattice_is_turned(&probes.level[level].lattice)) {
            return "the format holds no lattice that is turned";
        }
        if (probes.level[level].lattice.spacing != spacing) {
            return "the format holds levels of twice the spacing each";
        }
    }
    return lmb_probes_cuts_are_sane(&probes) ? nullptr : "a cut cell names probes or planes that are not its own";
}

} // namespace

lmb_result lmb_vdb_write(const char *path, const lmb_probes *probes, const lmb_vdb_metadata *metadata, lmb_error *error)
{
    assert(path && probes && metadata && metadata->settings && metadata->scene_hash);
    const char *const refused = refusal(*probes);
    if (refused) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: %s", path, refused);
    }
    char *const temporary = lmb_file_temporary_path(path);
    if (!temporary) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    lmb_result result =
        guarded(path, LMB_ERROR_WRITE, error, [&] { lmb_vdb::write_file(temporary, *probes, *metadata); });
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
        const lmb_vdb::File file = lmb_vdb::read_file(path);
        *probes = file.probes;
        for (const auto &text :
             {std::make_pair(settings, file.settings), std::make_pair(scene_hash, file.scene_hash)}) {
            if (text.first) {
                *text.first = text.second;
            } else {
                std::free(text.second);
            }
        }
    });
}
