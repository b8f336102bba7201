/* What the bake can do without, to measure what each part is worth. Results stay unbiased. */
#ifndef LMB_ABLATION_H
#define LMB_ABLATION_H

enum {
    LMB_WITHOUT_ENVIRONMENT_AIM = 1, /* lmb_emitters_environment_sampled is false: rays by chance find the sky */
    LMB_WITHOUT_TRIANGLE_AIM = 2,    /* no triangle is sampled as a light */
    LMB_WITHOUT_TRIANGLE_TREE = 4,   /* triangles are chosen evenly */
    LMB_WITHOUT_SEQUENCE = 8,        /* independent variates in its place */
    LMB_WITHOUT_CELL_AIM = 16        /* bright cells are not aimed at */
};

#endif
