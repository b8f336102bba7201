// What reading and writing share that knows OpenVDB's grids, and the grids of local sets.
#ifndef LAMBENT_VDB_GRIDS_HH
#define LAMBENT_VDB_GRIDS_HH

#include "vdb_internal.hh"

#include <lambent/probe_local.h>

#include <unordered_map>

#include <openvdb/openvdb.h>

namespace lmb_vdb {

// All of a file's, by name.
using GridMap = std::unordered_map<std::string, openvdb::GridBase::Ptr>;

template <typename GridType> typename GridType::Ptr find_grid(const GridMap &grids, const std::string &name)
{
    const auto found = grids.find(name);
    if (found == grids.end()) {
        fail(LMB_ERROR_FORMAT, "has no grid " + name);
    }
    const typename GridType::Ptr typed = openvdb::gridPtrCast<GridType>(found->second);
    if (!typed) {
        fail(LMB_ERROR_FORMAT,
             "grid " + name + " is of type " + found->second->type() + ", not " + GridType::gridType());
    }
    return typed;
}

// What a reader needs to interpret the values; on the file and on every grid, as editors keep only the latter.
void describe(openvdb::MetaMap &target, const lmb_probes &probes, uint32_t level, float scale);

// The version, and the power of two that a grid's values were divided by.
void check_version(const openvdb::MetaMap &grid);
float read_scale(const openvdb::GridBase &grid);

// Appends the grids of all local sets; `validity` is the finest level's and gets their number, if there are any.
void add_locals(const lmb_probes &probes, float scale, openvdb::GridBase &validity, openvdb::GridPtrVec &grids);

// A local set's grids.
struct LocalGrids {
    std::string name;
    int32_t node, place;
    openvdb::Vec3SGrid::Ptr coefficient[LMB_SH3_COUNT];
    openvdb::FloatGrid::Ptr validity;
    std::vector<openvdb::FloatGrid::Ptr> visibility; // of key lights
};

// Those that the finest level's `validity` says there are.
std::vector<LocalGrids> find_locals(const GridMap &grids, const openvdb::FloatGrid &validity, uint32_t key_lights);

void read_local(const LocalGrids &local, lmb_probes &probes);

} // namespace lmb_vdb

#endif
