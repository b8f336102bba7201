/* What finding regions goes through: cells, what is seen in those that geometry touches, groups of corners. */
#ifndef LMB_REGIONS_INTERNAL_H
#define LMB_REGIONS_INTERNAL_H

#include <lambent/regions.h>
#include <lambent/vector.h>

/* A cell is looked at from nodes, SIDE along each axis, of which the outermost lie just within its faces. */
enum {
    LMB_REGION_SIDE = 6,
    LMB_REGION_LINES = LMB_REGION_SIDE * LMB_REGION_SIDE, /* along each axis */
    LMB_REGION_NODES = LMB_REGION_LINES * LMB_REGION_SIDE,
    LMB_REGION_NONE = 255
};

/* Spacings that the outermost nodes keep from the faces. */
#define LMB_REGION_INSET 0.002f

/* Coordinate of a node along an axis, 0 to 1. */
float lmb_region_node(int i);

/* Coordinates of a node in its cell. */
void lmb_region_node_at(int node, float t[3]);

/* How far apart nodes that follow each other along an axis are in their numbers. */
static inline int lmb_region_stride(int axis)
{
    return axis == 0 ? 1 : axis == 1 ? LMB_REGION_SIDE : LMB_REGION_LINES;
}

/* Node `i` of one of the lines of nodes along an axis. */
static inline int lmb_region_line_node(int axis, int line, int i)
{
    const int other = axis == 0 ? LMB_REGION_SIDE : 1;
    const int last = axis == 2 ? LMB_REGION_SIDE : LMB_REGION_LINES;
    return i * lmb_region_stride(axis) + line % LMB_REGION_SIDE * other + line / LMB_REGION_SIDE * last;
}

/* Where a ray from a node ends at a surface. */
typedef struct lmb_region_end {
    uint8_t node, axis;
    bool unseen; /* the surface's back, which its material does not show */
    uint16_t at; /* along the axis, in 65535ths of the cell */
} lmb_region_end;

/* What was seen in a cell that a triangle touches. */
typedef struct lmb_region_look {
    uint8_t label[LMB_REGION_NODES]; /* the region of each node, or LMB_REGION_NONE */
    uint8_t count;                   /* of regions */
    uint64_t open[6]; /* [2 axis, 2 axis + 1: the low face, the high one] bit of a line: it goes on beyond the face */
    uint8_t real[LMB_CELL_REGIONS_MOST]; /* bit of a corner: the region sees its baked probe */
    bool lamp;                           /* something in it shines: light changes fast */
    uint32_t end_count;
    lmb_region_end *end;
} lmb_region_look;

typedef struct lmb_region_cell {
    int32_t point[3];
    uint32_t level;
    uint32_t look;  /* its number, or UINT32_MAX: nothing touches it; then it is one region */
    uint32_t first; /* of its regions */
    uint32_t count; /* of regions */
    uint8_t probes; /* corners that have one */
} lmb_region_cell;

/* A corner of a finer region that touches a coarser one, at t in the coarser one's cell. */
typedef struct lmb_region_link {
    uint32_t fine, coarse; /* regions */
    uint32_t level, steps; /* of the finer one, and levels from it to the coarser one */
    uint8_t corner;        /* of the finer cell */
    float t[3];
} lmb_region_link;

/* A value that is made of others', of coarser levels. */
typedef struct lmb_region_hanging {
    int32_t value;
    uint32_t level;
    int32_t parent[8];
    float weight[8];
} lmb_region_hanging;

typedef struct lmb_region_work {
    const lmb_tracer *tracer;
    lmb_pool *pool;
    const lmb_progress *progress;
    lmb_probes *probes;
    lmb_region_cell *cell;
    uint32_t cell_count, cell_room;
    lmb_probe_index *index; /* [level] cells, by their first points */
    lmb_region_look *look;
    uint32_t *looked; /* [look] its cell */
    uint32_t look_count;
    lmb_vec3 *place; /* [probe] where light is gathered, of baked ones that looked-at cells have at their corners */
    int32_t *placed; /* these */
    uint32_t region_count;
    uint32_t *root;       /* [8 region + corner] a parent in the forest of corners that are one value */
    uint8_t *reached;     /* [region] somebody can be in it */
    int32_t (*corner)[8]; /* [region] probes and ghosts; -1: not reached */
    lmb_region_link *link;
    uint32_t link_count, link_room;
    uint64_t *rays;       /* [thread] */
    lmb_regions *regions; /* being made */
    lmb_regions_stats *stats;
} lmb_region_work;

/* A cell in the scene: t in it lies at first + t[0] step[0] + t[1] step[1] + t[2] step[2]. */
typedef struct lmb_region_frame {
    lmb_vec3 first, step[3];
    float spacing;
} lmb_region_frame;

lmb_region_frame lmb_region_frame_of(const lmb_probes *probes, const lmb_region_cell *cell);
lmb_vec3 lmb_region_position(const lmb_region_frame *frame, const float t[3]);

/* A place of a region that is just before a surface, where one of its corners that are to be fitted weighs most. */
typedef struct lmb_region_place {
    uint32_t region;
    float t[3];
} lmb_region_place;

struct lmb_regions {
    size_t point_count;
    lmb_region_point *point;
    size_t place_count;
    lmb_region_place *place;
    uint32_t region_count; /* that have anything to fit */
    int32_t (*corner)[8];  /* [region] */
    size_t hanging_count;
    lmb_region_hanging *hanging; /* those of coarser levels first */
    uint8_t *hangs;              /* [probe] */
    uint32_t unknown_count;
    int32_t *unknown;    /* probes and ghosts that are fitted */
    int32_t *unknown_of; /* [probe] which of them it is, or -1 */
};

/* Finds the cells that have a probe at any corner, or are beside them, and which of these triangles touch.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_region_cells_find(lmb_region_work *work);

/* Looks into the cells that are touched. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_region_cells_look(lmb_region_work *work);

/* Surfaces along a line of nodes of a cell, from the node before it to the one after it: coordinates along the axis,
 * and hits, nearest first. */
enum { LMB_REGION_HITS_MOST = 64 };
typedef struct lmb_region_line {
    int count;
    float at[LMB_REGION_HITS_MOST];
    lmb_hit hit[LMB_REGION_HITS_MOST];
} lmb_region_line;
void lmb_region_line_trace(const lmb_tracer *tracer, const lmb_region_frame *frame, int axis, int line,
                           lmb_region_line *found, uint64_t *rays);

/* The last node of a line that is not beyond a coordinate; -1: all are. */
int lmb_region_node_before(float at);

/* Finds which corners of regions are one value, which regions can be reached, and gives each value a probe of the
 * lattice, or a ghost that is added to the probes. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_corners_name(lmb_region_work *work);

/* Finds which corners of regions touch those of coarser levels. */
lmb_result lmb_region_levels_link(lmb_region_work *work);

/* Finds the values that hang on coarser levels, once cells are cut. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_hanging_find(lmb_region_work *work);

/* Trilinear weights of corners. */
static inline void lmb_region_weights(const float t[3], float weight[8])
{
    for (int i = 0; i < 8; ++i) {
        weight[i] = (i & 1 ? t[0] : 1.0f - t[0]) * (i & 2 ? t[1] : 1.0f - t[1]) * (i & 4 ? t[2] : 1.0f - t[2]);
    }
}

/* A tree of planes that tells a cell's regions apart. */
typedef struct lmb_region_tree {
    uint32_t plane_count;
    lmb_cell_plane plane[LMB_CELL_PLANES_MOST];
    uint32_t strays;
} lmb_region_tree;

/* Labels are named by `name`; LMB_REGION_NONE: there is nobody in it. */
void lmb_region_tree_grow(const lmb_region_work *work, const lmb_region_cell *cell,
                          const uint8_t name[LMB_CELL_REGIONS_MOST], lmb_region_tree *tree, uint64_t *rays);

/* Cuts the cells that need it. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_region_cells_cut(lmb_region_work *work);

/* Chooses points to gather at. @return LMB_ERROR_MEMORY */
lmb_result lmb_region_points_choose(lmb_region_work *work);

#endif
