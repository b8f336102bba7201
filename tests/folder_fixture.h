/* A folder of a test program's own. Needs POSIX. */
#ifndef LMB_TESTS_FOLDER_FIXTURE_H
#define LMB_TESTS_FOLDER_FIXTURE_H

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static inline bool entry_is_folder_itself(const struct dirent *entry)
{
    return strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0;
}

/* Makes it, or removes the files in it. */
static inline void folder_start(const char *folder)
{
    mkdir(folder, 0777);
    DIR *const opened = opendir(folder);
    for (const struct dirent *entry = readdir(opened); entry; entry = readdir(opened)) {
        char path[2048];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (!entry_is_folder_itself(entry)) {
            remove(path);
        }
    }
    closedir(opened);
}

static inline int folder_entry_count(const char *folder)
{
    int count = 0;
    DIR *const opened = opendir(folder);
    for (const struct dirent *entry = readdir(opened); entry; entry = readdir(opened)) {
        count += !entry_is_folder_itself(entry);
    }
    closedir(opened);
    return count;
}

#endif
