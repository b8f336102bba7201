/* The machine that something was measured on. */
#ifndef LMB_TOOLS_MACHINE_H
#define LMB_TOOLS_MACHINE_H

/* Processor, how many, compiler, version: one line. */
void machine_text(char text[512]);

#endif
