// OpenVDB and NanoVDB as `lambent bench` times them. Every entry that may throw catches everything.
#include "bench_grids.h"

#include <memory>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#ifdef LMB_HAS_NANOVDB
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#endif

namespace {

using openvdb::Vec3SGrid;

struct OpenGrids {
    Vec3SGrid::Ptr grid[LMB_SH3_COUNT];
    double inverse_spacing = 1.0;
};

void set_coefficient(lmb_sh3_rgb &radiance, int i, float red, float green, float blue)
{
    radiance.channel[0].c[i] = red;
    radiance.channel[1].c[i] = green;
    radiance.channel[2].c[i] = blue;
}

// Nine accessors that each keep the way to the last voxel, as the libraries advise for samples near each other.
void sample_openvdb(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    const OpenGrids &grids = *static_cast<const OpenGrids *>(data);
    std::vector<Vec3SGrid::ConstAccessor> accessor;
    for (const Vec3SGrid::Ptr &grid : grids.grid) {
        accessor.push_back(grid->getConstAccessor());
    }
    for (size_t k = 0; k < count; ++k) {
        const openvdb::Vec3R at(static_cast<double>(position[k].x) * grids.inverse_spacing,
                                static_cast<double>(position[k].y) * grids.inverse_spacing,
                                static_cast<double>(position[k].z) * grids.inverse_spacing);
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const openvdb::Vec3s value = openvdb::tools::BoxSampler::sample(accessor[static_cast<size_t>(i)], at);
            set_coefficient(radiance[k], i, value[0], value[1], value[2]);
        }
    }
}

void destroy_openvdb(void *data)
{
    delete static_cast<OpenGrids *>(data);
}

std::unique_ptr<OpenGrids> make_openvdb(const lmb_probes &probes)
{
    auto grids = std::make_unique<OpenGrids>();
    const double spacing = static_cast<double>(probes.level[0].lattice.spacing);
    grids->inverse_spacing = 1.0 / spacing;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        grids->grid[i] = Vec3SGrid::create(openvdb::Vec3s(0.0f));
        grids->grid[i]->setTransform(openvdb::math::Transform::createLinearTransform(spacing));
        Vec3SGrid::Accessor accessor = grids->grid[i]->getAccessor();
        for (int32_t probe = 0; probe < probes.count - probes.ghost_count; ++probe) {
            const lmb_sh3_rgb &light = probes.radiance[0][probe];
            accessor.setValue(openvdb::Coord(probes.point[probe]),
                              openvdb::Vec3s(light.channel[0].c[i], light.channel[1].c[i], light.channel[2].c[i]));
        }
    }
    return grids;
}

lmb_bench_sampler openvdb_sampler(std::unique_ptr<OpenGrids> grids)
{
    lmb_bench_sampler sampler = {"openvdb", nullptr, 0.0, sample_openvdb, destroy_openvdb};
    for (const Vec3SGrid::Ptr &grid : grids->grid) {
        sampler.bytes += static_cast<double>(grid->memUsage());
    }
    sampler.data = grids.release();
    return sampler;
}

#ifdef LMB_HAS_NANOVDB

struct NanoGrids {
    nanovdb::GridHandle<> handle[LMB_SH3_COUNT];
    const nanovdb::Vec3fGrid *grid[LMB_SH3_COUNT] = {};
    double inverse_spacing = 1.0;
};

void sample_nanovdb(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    using Accessor = nanovdb::Vec3fGrid::AccessorType;
    using Sampler = nanovdb::SampleFromVoxels<Accessor, 1, false>;
    const NanoGrids &grids = *static_cast<const NanoGrids *>(data);
    std::vector<Accessor> accessor;
    for (const nanovdb::Vec3fGrid *grid : grids.grid) {
        accessor.push_back(grid->getAccessor());
    }
    std::vector<Sampler> sampler(accessor.begin(), accessor.end());
    for (size_t k = 0; k < count; ++k) {
        const nanovdb::Vec3d at(static_cast<double>(position[k].x) * grids.inverse_spacing,
                                static_cast<double>(position[k].y) * grids.inverse_spacing,
                                static_cast<double>(position[k].z) * grids.inverse_spacing);
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const nanovdb::Vec3f value = sampler[static_cast<size_t>(i)](at);
            set_coefficient(radiance[k], i, value[0], value[1], value[2]);
        }
    }
}

void destroy_nanovdb(void *data)
{
    delete static_cast<NanoGrids *>(data);
}

lmb_bench_sampler make_nanovdb(const OpenGrids &open)
{
    auto grids = std::make_unique<NanoGrids>();
    lmb_bench_sampler sampler = {"nanovdb", nullptr, 0.0, sample_nanovdb, destroy_nanovdb};
    grids->inverse_spacing = open.inverse_spacing;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        grids->handle[i] = nanovdb::openToNanoVDB(*open.grid[i]);
        grids->grid[i] = grids->handle[i].grid<nanovdb::Vec3f>();
        sampler.bytes += static_cast<double>(grids->handle[i].size());
    }
    sampler.data = grids.release();
    return sampler;
}

#endif

} // namespace

int bench_grids_create(const lmb_probes *probes, lmb_bench_sampler sampler[BENCH_GRID_SAMPLERS])
{
    int count = 0;
    try {
        openvdb::initialize();
        std::unique_ptr<OpenGrids> open = make_openvdb(*probes);
#ifdef LMB_HAS_NANOVDB
        sampler[count] = make_nanovdb(*open);
        ++count;
#endif
        sampler[count] = openvdb_sampler(std::move(open));
        return count + 1;
    } catch (...) {
        for (int i = 0; i < count; ++i) {
            bench_sampler_destroy(&sampler[i]);
        }
        return 0;
    }
}
