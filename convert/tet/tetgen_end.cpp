// SPDX-License-Identifier: AGPL-3.0-or-later

// TetGen ends by this function, and its own version frees the mesh twice. This unit must not include TetGen's
// header: some builds of the library declare the function inline there.
class tetgenmesh;
void terminatetetgen(tetgenmesh*, int reason) {
  throw reason;
}
