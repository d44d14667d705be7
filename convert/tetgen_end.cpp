// SPDX-License-Identifier: AGPL-3.0-or-later

// TetGen ends by this function, and its own version frees the mesh twice. It must not see TetGen's header,
// where the function is declared inline in other builds of the library.
class tetgenmesh;
void terminatetetgen(tetgenmesh*, int reason) {
  throw reason;
}
