# Draws the worlds of this folder:
#
#   for world in $(awk -f draw.awk -v list=1); do awk -f draw.awk -v world=$world > $world.yaml; done
#
# Each lies in a room of 12 m by 10 m; the robot begins at (1, 5) and looks at its goal at (11, 5). Lengths are metres. Any awk gives
# the same bytes.

# Walls as "x,y x,y x,y": a line through these points. Several lines are separated by |.
function walls(text,    l, lines, n, p, points, i, a, b) {
  lines = split(text, l, "|")
  for (n = 1; n <= lines; ++n) {
    points = split(l[n], p, " ")
    for (i = 2; i <= points; ++i) {
      split(p[i - 1], a, ",")
      split(p[i], b, ",")
      segments = segments sprintf("  - [[%.2f m, %.2f m], [%.2f m, %.2f m]]\n", a[1], a[2], b[1], b[2])
    }
  }
}

# A door of 0.1 m by its length along y, its middle on its way "time:x,y time:x,y".
function door(name, length_, way) { body(name, 0.1, length_, way, "") }

function body(name, depth, length_, way, again,    n, w, part, at, i) {
  moving = moving sprintf("  - {name: %s, size: [%.2f m, %.2f m], path: [", name, depth, length_)
  n = split(way, w, " ")
  for (i = 1; i <= n; ++i) {
    split(w[i], part, ":")
    split(part[2], at, ",")
    moving = moving sprintf("%s{at: %d s, pose: [%.2f m, %.2f m, 0 deg]}", i > 1 ? ", " : "", part[1], at[1], at[2])
  }
  moving = moving "]" again "}\n"
}

function trap(name, text, ways) { about[name] = text; wall_of[name] = ways; names = names name "\n" }

BEGIN {
  trap("u_shallow", "a U of 3 m by 1 m, open to the robot", "5,3.5 6,3.5 6,6.5 5,6.5")
  trap("u_deep", "a U of 3 m by 4 m, open to the robot", "3,3.5 7,3.5 7,6.5 3,6.5")
  trap("u_narrow", "a U of 1.6 m by 4 m, open to the robot", "3,4.2 7,4.2 7,5.8 3,5.8")
  trap("u_behind", "the goal is in a U that opens behind it", "10.9,3.8 9,3.8 9,6.2 10.9,6.2")
  trap("u_around", "the robot begins in a U that opens behind it", "1.1,3.8 3,3.8 3,6.2 1.1,6.2")
  trap("v_shape", "a V, open to the robot", "3,2 7,5 3,8")
  trap("corner", "a corner open to the robot, with one long wall", "4,8 7,8 7,0")
  trap("dead_end", "the straight corridor is a dead end, the bent one leads on", "2,4.3 8,4.3 8,5.7 2,5.7|8,5.7 8,8.4|8,4.3 8,0")
  trap("double_u", "a U in a U, one beside the other's opening", "2.5,3 8,3 8,8 2.5,8|3.8,4 6,4 6,6.2 3.8,6.2")
  trap("spiral", "the goal is in the middle of a spiral", "12,2 4,2 4,9 8.4,9|5.6,2 5.6,7.4 10.4,7.4|7.2,3.4 7.2,6 9.6,6 9.6,3.6")
  trap("comb", "a wall with three pockets", "5,1.5 7,1.5 7,3.4 5,3.4|7,3.4 7,4.2|5,4.2 7,4.2|7,4.2 7,5.8|5,5.8 7,5.8|7,5.8 7,6.6|5,6.6 7,6.6 7,8.5 5,8.5")
  trap("slit", "a slit of 0.4 m straight ahead, too narrow, and a way round", "6,1.6 6,4.8|6,5.2 6,10")
  trap("narrow_door", "the only door is 1.0 m wide and off the straight line", "6,0 6,7|6,8 6,10")
  trap("zigzag", "walls from either side, one after the other", "3.5,0 3.5,7.5|6,10 6,2.5|8.5,0 8.5,7.5")
  trap("corridor", "the only way is a corridor, 0.9 m wide", "3,0 3,4.55 8,4.55 8,0|3,10 3,5.45 8,5.45 8,10")
  trap("closed_goal", "the goal is walled in: there is no way", "9,3.5 11.8,3.5 11.8,6.5 9,6.5 9,3.5")
  trap("closed_start", "the robot is walled in: there is no way", "0.2,3 4,3 4,7 0.2,7 0.2,3")
  trap("door_closes", "a door closes before the robot; there is another way", "6,0 6,1.4|6,2.8 6,4.3|6,5.7 6,10")
  trap("door_locks", "the only door closes before the robot: there is no way any more", "6,0 6,4.3|6,5.7 6,10")
  trap("door_opens", "the only door closes before the robot, and opens again", "6,0 6,4.3|6,5.7 6,10")
  trap("two_doors", "of two doors, one closes when the other opens", "6,0 6,1.8|6,3.2 6,6.8|6,8.2 6,10")
  trap("cart_waits", "a cart stands in the only door, and leaves after a while", "6,0 6,4.3|6,5.7 6,10")
  trap("cart_patrols", "a cart goes to and fro behind the only door", "6,0 6,4.3|6,5.7 6,10")
  if (list) {
    printf "%s", names
    exit 0
  }
  if (!(world in about)) {
    print "draw.awk: there is no world '" world "'; there are:\n" names > "/dev/stderr"
    exit 2
  }
  walls("0,0 12,0 12,10 0,10 0,0")
  walls(wall_of[world])
  if (world == "door_closes") door("door", 1.3, "0:6,7 6:6,7 8:6,5")
  if (world == "door_locks") door("door", 1.3, "0:6,7 6:6,7 8:6,5")
  if (world == "door_opens") door("door", 1.3, "0:6,7 6:6,7 8:6,5 20:6,5 22:6,7")
  if (world == "two_doors") {
    door("lower", 1.3, "0:6,4 6:6,4 8:6,2.5 24:6,2.5 26:6,4")
    door("upper", 1.3, "0:6,7.5 6:6,7.5 8:6,6 24:6,6 26:6,7.5")
  }
  if (world == "cart_waits") body("cart", 0.8, 1.0, "0:6,5 30:6,5 45:9,8", "")
  if (world == "cart_patrols") body("cart", 0.5, 0.5, "0:7.4,3 16:7.4,7 32:7.4,3", ", repeat: true")
  printf "# A trap: %s.\n", about[world]
  printf "#\n# start: [1.00 m, 5.00 m, 0 deg], goal (11, 5)\n"
  printf "# Drawn by draw.awk: change that, not this. Frame map, x to the right, y up.\n"
  printf "kervan_world: 1\nname: %s\nsegments:\n%s", world, segments
  if (moving != "") printf "moving:\n%s", moving
}
