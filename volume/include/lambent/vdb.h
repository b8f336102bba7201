/* probes.vdb, the exchange format: OpenVDB grids that Blender, Houdini and vdb_print open (docs/formats.md).
 *
 * For each level nine Vec3s grids, one per SH coefficient, half floats on disk, one float grid of validity, and one of
 * the visibility of each key light, which share one topology and a linear transform in metres; the same again for its
 * ghosts. Cut cells are among the metadata of validity. No C++ type or exception crosses this
 * header. */
#ifndef LAMBENT_VDB_H
#define LAMBENT_VDB_H

#include <lambent/probes.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Stored in the file's metadata; strings are UTF-8, NUL-terminated, never NULL on writing. */
typedef struct lmb_vdb_metadata {
    const char *settings;   /* JSON of the bake's settings */
    const char *scene_hash; /* hexadecimal content hash of level and environment */
} lmb_vdb_metadata;

/* Writes probes whose lattices are not turned and double in spacing, of one set of lights, with up to 64 ghosts a
 * point; beside, then renames. The file's UUID is a hash of its content: equal probes give equal bytes.
 * @return LMB_ERROR_WRITE, _MEMORY, _ARGUMENT (no level, several sets, lattices or ghosts that it does not hold, broken
 * cut cells or key lights, radiance that no scale brings into fp16, or that is not finite); then a file that was there
 * still is */
lmb_result lmb_vdb_write(const char *path, const lmb_probes *probes, const lmb_vdb_metadata *metadata,
                         lmb_error *error);

/* Reads a file of ours back, edited or not: probes in the order of their points, ghosts in that in which cut cells name
 * them. A cut cell that has lost a probe is not cut any more. `*settings` and `*scene_hash` are malloc'ed strings;
 * either pointer may be NULL. @return LMB_ERROR_IO, _FORMAT (not a .vdb, grids missing, topologies differ), _VERSION,
 * _MEMORY */
lmb_result lmb_vdb_read(const char *path, lmb_probes **probes, char **settings, char **scene_hash, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
