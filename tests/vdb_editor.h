/* What other tools do to a .vdb: its grids are read by OpenVDB, changed, and written again with a UUID of OpenVDB's. */
#ifndef LMB_TESTS_VDB_EDITOR_H
#define LMB_TESTS_VDB_EDITOR_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All return false where the file, the grid or the metadata is not there. */

/* Makes a voxel inactive in the grids of one set: those called sh_N, validity and key_visibility_N with `suffix`. */
bool vdb_editor_remove(const char *path, const char *suffix, const int32_t voxel[3]);

/* Drops such a set. */
bool vdb_editor_drop_set(const char *path, const char *suffix);

/* Multiplies the values of all active voxels of a grid of vectors. */
bool vdb_editor_multiply(const char *path, const char *grid, float factor);

typedef enum vdb_editor_compression {
    VDB_EDITOR_BLOSC,     /* and without inactive voxels, as OpenVDB does unless told otherwise */
    VDB_EDITOR_BLOSC_ALL, /* with inactive voxels */
    VDB_EDITOR_ZIP,       /* likewise */
    VDB_EDITOR_MASKS,     /* only without inactive voxels */
    VDB_EDITOR_NONE,
} vdb_editor_compression;

/* Saves it again, as it is. */
bool vdb_editor_save(const char *path, vdb_editor_compression compression);

bool vdb_editor_drop_grid(const char *path, const char *grid);
bool vdb_editor_drop_metadata(const char *path, const char *grid, const char *name);
bool vdb_editor_set_spacing(const char *path, const char *grid, double spacing);
bool vdb_editor_set_version(const char *path, const char *grid, int32_t version);

/* A text among the metadata of a grid, malloc'ed; or puts another there. */
char *vdb_editor_text(const char *path, const char *grid, const char *name);
bool vdb_editor_set_text(const char *path, const char *grid, const char *name, const char *text);

#ifdef __cplusplus
}
#endif

#endif
