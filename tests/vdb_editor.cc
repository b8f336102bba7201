#include "vdb_editor.h"

#include <cstring>
#include <functional>
#include <string>

#include <openvdb/openvdb.h>

namespace {

using openvdb::GridBase;

uint32_t flags_of(vdb_editor_compression compression)
{
    switch (compression) {
    case VDB_EDITOR_BLOSC_ALL:
        return openvdb::io::COMPRESS_BLOSC;
    case VDB_EDITOR_ZIP:
        return openvdb::io::COMPRESS_ZIP;
    case VDB_EDITOR_MASKS:
        return openvdb::io::COMPRESS_ACTIVE_MASK;
    case VDB_EDITOR_NONE:
        return openvdb::io::COMPRESS_NONE;
    default:
        return openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;
    }
}

// Reads all grids, lets `edit` see each, and writes those that it returns true for.
bool edit_grids(const char *path, const std::function<bool(GridBase &)> &edit,
                vdb_editor_compression compression = VDB_EDITOR_BLOSC)
{
    try {
        openvdb::initialize();
        openvdb::io::File source(path);
        source.open(false);
        const openvdb::GridPtrVecPtr grids = source.getGrids();
        const openvdb::MetaMap::Ptr metadata = source.getMetadata();
        source.close();
        openvdb::GridPtrVec kept;
        for (const GridBase::Ptr &grid : *grids) {
            if (edit(*grid)) {
                kept.push_back(grid);
            }
        }
        openvdb::io::File file(path);
        file.setCompression(flags_of(compression));
        file.write(kept, *metadata);
        return true;
    } catch (const std::exception &) {
        return false;
    }
}

// Edits one grid. @return whether it was there and `edit` returned true
bool edit_grid(const char *path, const std::string &name, const std::function<bool(GridBase &)> &edit)
{
    bool done = false;
    return edit_grids(path,
                      [&](GridBase &grid) {
                          if (grid.getName() == name) {
                              done = edit(grid);
                          }
                          return true;
                      }) &&
           done;
}

template <typename GridType> void remove_voxel(GridBase &grid, const openvdb::Coord &at)
{
    GridType *const typed = dynamic_cast<GridType *>(&grid);
    if (typed) {
        typed->tree().setValueOff(at, typed->background());
    }
}

bool is_of_set(const std::string &name, const std::string &suffix)
{
    const auto matches = [&](const std::string &stem) { return name == stem + suffix; };
    bool found = matches("validity");
    for (int i = 0; i < 9; ++i) {
        found = found || matches("sh_" + std::to_string(i)) || matches("key_visibility_" + std::to_string(i));
    }
    return found;
}

} // namespace

bool vdb_editor_save(const char *path, vdb_editor_compression compression)
{
    return edit_grids(
        path, [](GridBase &) { return true; }, compression);
}

bool vdb_editor_remove(const char *path, const char *suffix, const int32_t voxel[3])
{
    int count = 0;
    return edit_grids(path,
                      [&](GridBase &grid) {
                          if (is_of_set(grid.getName(), suffix)) {
                              remove_voxel<openvdb::FloatGrid>(grid, openvdb::Coord(voxel));
                              remove_voxel<openvdb::Vec3SGrid>(grid, openvdb::Coord(voxel));
                              ++count;
                          }
                          return true;
                      }) &&
           count >= 10;
}

bool vdb_editor_drop_set(const char *path, const char *suffix)
{
    int count = 0;
    return edit_grids(path,
                      [&](GridBase &grid) {
                          const bool is_it = is_of_set(grid.getName(), suffix);
                          count += is_it;
                          return !is_it;
                      }) &&
           count >= 10;
}

bool vdb_editor_multiply(const char *path, const char *grid, float factor)
{
    return edit_grid(path, grid, [&](GridBase &found) {
        openvdb::Vec3SGrid &vectors = dynamic_cast<openvdb::Vec3SGrid &>(found);
        for (auto value = vectors.beginValueOn(); value; ++value) {
            value.setValue(*value * factor);
        }
        return true;
    });
}

bool vdb_editor_drop_grid(const char *path, const char *grid)
{
    bool found = false;
    return edit_grids(path,
                      [&](GridBase &each) {
                          const bool is_it = each.getName() == grid;
                          found = found || is_it;
                          return !is_it;
                      }) &&
           found;
}

bool vdb_editor_drop_metadata(const char *path, const char *grid, const char *name)
{
    return edit_grid(path, grid, [&](GridBase &found) {
        const bool is_there = bool(found[name]);
        found.removeMeta(name);
        return is_there;
    });
}

bool vdb_editor_set_spacing(const char *path, const char *grid, double spacing)
{
    return edit_grid(path, grid, [&](GridBase &found) {
        found.setTransform(openvdb::math::Transform::createLinearTransform(spacing));
        return true;
    });
}

bool vdb_editor_set_version(const char *path, const char *grid, int32_t version)
{
    return edit_grid(path, grid, [&](GridBase &found) {
        found.insertMeta("lambent_version", openvdb::Int32Metadata(version));
        return true;
    });
}

char *vdb_editor_text(const char *path, const char *grid, const char *name)
{
    try {
        openvdb::initialize();
        openvdb::io::File source(path);
        source.open(false);
        return strdup(source.readGridMetadata(grid)->metaValue<std::string>(name).c_str());
    } catch (const std::exception &) {
        return nullptr;
    }
}

bool vdb_editor_set_text(const char *path, const char *grid, const char *name, const char *text)
{
    return edit_grid(path, grid, [&](GridBase &found) {
        found.insertMeta(name, openvdb::StringMetadata(text));
        return true;
    });
}
