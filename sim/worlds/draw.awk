# Draws the worlds of this folder that are too long to be written by hand:
#
#   awk -f draw.awk -v world=office > office.yaml        # rods, clutter, rescue_1 … rescue_4 or office
#
# Lengths are metres, angles degrees. Any awk gives the same bytes.

# A wall along x at height y from x1 to x2. `doors` are gaps, "middle:width middle:width", from the left to the right.
function wall_x(y, x1, x2, doors,    n, d, i, part) {
  n = split(doors, d, " ")
  for (i = 1; i <= n; ++i) {
    split(d[i], part, ":")
    segment(x1, y, part[1] - part[2] / 2, y)
    x1 = part[1] + part[2] / 2
  }
  segment(x1, y, x2, y)
}

# The same along y at x.
function wall_y(x, y1, y2, doors,    n, d, i, part) {
  n = split(doors, d, " ")
  for (i = 1; i <= n; ++i) {
    split(d[i], part, ":")
    segment(x, y1, x, part[1] - part[2] / 2)
    y1 = part[1] + part[2] / 2
  }
  segment(x, y1, x, y2)
}

function outer_walls(width, height) {
  segment(0, 0, width, 0)
  segment(width, 0, width, height)
  segment(width, height, 0, height)
  segment(0, height, 0, 0)
}

function segment(x1, y1, x2, y2) {
  segments = segments sprintf("  - [[%.2f m, %.2f m], [%.2f m, %.2f m]]\n", x1, y1, x2, y2)
}

function disc(x, y, radius) {
  circles = circles sprintf("  - {center: [%.2f m, %.2f m], radius: %.2f m}\n", x, y, radius)
}

function box(x, y, width, height, yaw) {
  boxes = boxes sprintf("  - {center: [%.2f m, %.2f m], size: [%.2f m, %.2f m]%s}\n", x, y, width, height,
                        yaw == 0 ? "" : sprintf(", yaw: %d deg", yaw))
}

# Pieces of furniture or rubble, "x,y,width,height,yaw" or "x,y,radius", separated by spaces.
function pieces(list,    n, p, i, f, k) {
  n = split(list, p, " ")
  for (i = 1; i <= n; ++i) {
    k = split(p[i], f, ",")
    if (k == 3)
      disc(f[1], f[2], f[3])
    else
      box(f[1], f[2], f[3], f[4], f[5])
  }
}

# Uniform in [0, 1), by Lehmer's generator: exact in any awk, as rand() is not.
function uniform() {
  state = (state * 16807) % 2147483647
  return state / 2147483647
}

function rods(    count, tries, x, y, i, free, xs, ys) {
  say("A field of rods, 24 m by 16 m, for driving among obstacles without stopping (virtual force field). The paper describes")
  say("its robot's surroundings in words only: the field, its size and its rods are ours. The rods have a radius of 0.05 m,")
  say("so that none within 5 m can stand between two of a sonar's 32 rays. Between any two there are at least 2.6 m, more than")
  say("three times the diameter of 0.8 m of the Cybermotion K2A that the paper drives.")
  say("")
  say("start of a k2a: [-2.00 m, 8.00 m, 0 deg]  the goal on the other side is (26, 8)")
  say("start of a p3at: [-2.00 m, 4.00 m, 0 deg]  the goal on the other side is (26, 12)")
  state = 20090
  for (tries = 0; tries < 4000; ++tries) {
    x = 24 * uniform()
    y = 16 * uniform()
    free = 1
    for (i = 0; i < count; ++i) if ((x - xs[i]) ^ 2 + (y - ys[i]) ^ 2 < 2.71 ^ 2) free = 0
    if (!free) continue
    xs[count] = x
    ys[count++] = y
    disc(x, y, 0.05)
  }
}

# An alley with heaps of one to four cylinders on a grid of 0.15 m.
function clutter(    count, heap, heaps, most, tries, i, x, y, dx, dy, d, free, xs, ys, of) {
  say("An alley with clutter in it, in the manner of BARN (its paper: Perille et al. 2020), whose worlds are not among these:")
  say("barn.awk makes a world out of BARN's tables. This one is ours: heaps of cylinders with a radius of 0.075 m on a grid of")
  say("0.15 m, with at least 0.80 m between two heaps. The robot drives out of the alley at its upper end.")
  say("")
  say("start of a jackal: [-2.25 m, 3.00 m, 90 deg]  the goal is (-2.25, 13)")
  say("start of a p3dx: [-2.25 m, 3.00 m, 90 deg]  the same goal")
  segment(-4.5, 0, 0, 0)
  segment(-4.5, 0, -4.5, 9.6)
  segment(0, 0, 0, 9.6)
  count = heaps = 0
  state = 2020
  for (tries = 0; tries < 4000 && heaps < 24; ++tries) {
    x = -4.425 + 0.15 * int(30 * uniform())
    y = 5.025 + 0.15 * int(30 * uniform())
    most = 1 + int(4 * uniform())
    ++heaps
    heap = 0
    for (; heap < most; ++heap) {
      free = x > -4.43 && x < -0.07 && y > 5 && y < 9.5
      # At a wall, or with room for a robot to pass.
      if (x > -4.35 && x < -3.62 || x < -0.15 && x > -0.88) free = 0
      for (i = 0; i < count; ++i) {
        d = sqrt((x - xs[i]) ^ 2 + (y - ys[i]) ^ 2)
        if (d < (of[i] == heaps ? 0.1 : 0.95)) free = 0
      }
      if (!free) break
      xs[count] = x
      ys[count] = y
      of[count++] = heaps
      if (uniform() < 0.5) x += uniform() < 0.5 ? 0.15 : -0.15
      else y += uniform() < 0.5 ? 0.15 : -0.15
    }
    if (heap == 0) --heaps
  }
  for (i = 0; i < count; ++i) circles = circles sprintf("  - {center: [%.3f m, %.3f m], radius: 0.075 m}\n", xs[i], ys[i])
}

function rescue_comment(what) {
  say(what)
  say("The paper on vector field histograms (VFH, search and rescue, P3-AT) has four maps and does not give them; this floor of")
  say("20 m by 15 m is ours. A P3-AT gets into every room.")
  say("")
}

function rescue_1() {
  rescue_comment("Search and rescue, floor 1: eight rooms on both sides of a corridor, doors of 1.2 m, 21 pieces of furniture.")
  say("start of a p3at: [1.00 m, 7.50 m, 0 deg]  at the left end of the corridor")
  outer_walls(20, 15)
  wall_x(6.5, 0, 20, "2.5:1.2 7.0:1.2 13.0:1.2 17.5:1.2")
  wall_x(8.5, 0, 20, "3.5:1.2 8.0:1.2 12.0:1.2 16.5:1.2")
  wall_y(5, 0, 6.5, "1.5:1.2")
  wall_y(10, 0, 6.5, "")
  wall_y(15, 0, 6.5, "5.0:1.2")
  wall_y(5, 8.5, 15, "")
  wall_y(10, 8.5, 15, "13.0:1.2")
  wall_y(15, 8.5, 15, "")
  pieces("1.0,4.5,0.8,1.6,0 3.6,3.8,0.9,0.5,20 1.6,1.2,1.4,0.7,0 8.2,4.4,0.7,1.5,-15 6.6,2.4,0.45 8.8,0.9,1.6,0.7,0")
  pieces("11.3,4.6,1.2,0.6,35 13.2,2.6,0.7,1.4,0 11.2,1.2,0.4 17.0,3.0,1.8,0.8,45 18.9,1.2,0.8,1.6,0 19.2,5.2,0.5,1.2,0")
  pieces("1.5,13.2,1.6,0.8,0 3.2,11.2,0.9,0.9,30 6.6,11.2,0.5 8.0,13.8,1.8,0.7,0 11.6,10.6,0.6,1.2,10 13.5,13.6,1.2,1.2,0")
  pieces("17.3,11.2,2.0,0.8,-30 16.2,13.9,1.2,0.6,0 10.0,7.1,0.6,0.5,0")
}

function rescue_2() {
  rescue_comment("Search and rescue, floor 2: a hall and three rooms after a collapse, doors of 1.3 m, 44 pieces of rubble.")
  say("start of a p3at: [1.20 m, 7.50 m, 0 deg]  in the hall, at the left wall")
  outer_walls(20, 15)
  wall_y(12.5, 0, 15, "2.5:1.3 7.6:1.3 12.6:1.3")
  wall_x(5.2, 12.5, 20, "18.6:1.3")
  wall_x(10.0, 12.5, 20, "14.6:1.3")
  # In the hall one piece in each cell of a loose grid, so that there is a way between any two.
  state = 2004
  for (i = 0; i < 7; ++i)
    for (j = 0; j < 5; ++j) {
      if (i == 0 && j == 2) continue
      rubble(1.4 + 1.62 * i, 1.5 + 3.0 * j)
    }
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 3; ++j) rubble(14.8 + 2.0 * i, 2.4 + 5.0 * j)
  rubble(14.0, 6.4)
}

function rubble(x, y,    size) {
  x += 0.5 * uniform() - 0.25
  y += 1.0 * uniform() - 0.5
  size = 0.2 + 0.25 * uniform()
  if (uniform() < 0.3)
    disc(x, y, 0.8 * size)
  else
    box(x, y, 1.5 * size, size, int(180 * uniform()))
}

function rescue_3() {
  rescue_comment("Search and rescue, floor 3: three large rooms, openings of 1.5 m, hardly any furniture.")
  say("start of a p3at: [1.50 m, 1.50 m, 45 deg]  in the lower left corner")
  outer_walls(20, 15)
  wall_y(9, 0, 15, "4.0:1.5 11.5:1.5")
  wall_x(8, 9, 20, "14.5:1.5")
  pieces("4.5,7.5,2.4,1.2,0 14.5,4.0,0.6 15.5,11.5,1.6,0.8,30")
}

function rescue_4() {
  rescue_comment("Search and rescue, floor 4: eleven small rooms in a ring round a shaft, doors of 1.0 m, 25 pieces of furniture.")
  say("start of a p3at: [1.00 m, 1.00 m, 90 deg]  in the lower left room")
  outer_walls(20, 15)
  box(10, 7.5, 3.6, 2.6, 0)  # the shaft
  wall_y(4, 0, 5, "3.0:1.0")
  wall_y(8, 0, 5, "1.6:1.0")
  wall_y(12, 0, 5, "3.2:1.0")
  wall_y(16, 0, 5, "1.8:1.0")
  wall_x(5, 0, 20, "2.0:1.0 6.2:1.0 13.8:1.0 18.2:1.0")
  wall_x(10, 0, 20, "1.8:1.0 10.0:1.0 17.6:1.0")
  wall_y(5, 5, 10, "8.4:1.0")
  wall_y(15, 5, 10, "6.4:1.0")
  wall_y(6, 10, 15, "13.4:1.0")
  wall_y(13, 10, 15, "11.8:1.0")
  pieces("1.0,3.4,0.6,1.2,0 3.0,0.9,1.0,0.6,0 5.2,1.0,1.2,0.6,0 7.0,4.0,0.8,0.5,25 10.2,1.0,1.4,0.7,0 10.6,3.6,0.35")
  pieces("14.6,0.7,1.6,0.6,0 13.2,2.0,0.5,0.9,0 19.0,0.9,0.8,0.8,0 17.2,4.1,0.7,0.7,45 1.1,7.6,0.7,1.8,0 3.6,9.2,0.9,0.6,0")
  pieces("3.4,6.6,0.35 6.6,6.0,0.5,0.5,0 13.4,9.0,0.5,0.5,0 18.8,7.6,0.7,1.8,0 16.6,9.2,0.9,0.5,0 16.8,6.4,0.3")
  pieces("1.0,13.6,1.0,1.4,0 4.2,11.6,1.2,0.6,-20 8.0,13.9,2.0,0.8,0 9.4,11.9,0.4 11.8,14.0,0.8,1.0,0 15.4,13.4,1.6,0.8,30")
  pieces("18.6,12.6,0.8,1.8,0")
}

# A room for two at a corridor that runs along x: desks at the side walls, a cabinet.
function office_room(x, y, width, depth, up,    far) {
  far = up ? y + depth : y
  box(x + 0.45, up ? y + 0.62 * depth : y + 0.38 * depth, 0.8, 1.6, 0)
  box(x + width - 0.45, up ? y + 0.62 * depth : y + 0.38 * depth, 0.8, 1.6, 0)
  box(x + 0.5 * width, up ? far - 0.3 : far + 0.3, 1.6, 0.45, 0)
}

function office(    i, x, doors_low, doors_high) {
  say("A big office, 60 m by 40 m: 30 rooms along two corridors; between them two halls of desks, a canteen and two")
  say("meeting rooms; doors of 1.0 m and more. It is nobody's plan and in no paper. A Pioneer gets into every room.")
  say("")
  say("start of a p3dx: [2.00 m, 8.25 m, 0 deg]  at the left end of the lower corridor")
  say("start of a p3at: [58.00 m, 31.75 m, 180 deg]  at the right end of the upper corridor")
  outer_walls(60, 40)
  # Rooms of 4 m at the lower and at the upper wall, their doors alternately left and right of the middle.
  for (i = 0; i < 15; ++i) {
    x = 4 * i
    doors_low = doors_low sprintf(" %.2f:1.0", x + (i % 2 ? 2.6 : 1.4))
    doors_high = doors_high sprintf(" %.2f:1.0", x + (i % 2 ? 1.4 : 2.6))
    if (i > 0) wall_y(x, 0, 7, "")
    if (i > 0) wall_y(x, 33, 40, "")
    office_room(x, 0, 4, 7, 0)
    office_room(x, 33, 4, 7, 1)
  }
  wall_x(7, 0, 60, doors_low)
  wall_x(33, 0, 60, doors_high)
  # Between the corridors, which are 2.5 m wide and joined at both ends by passages of 3 m.
  wall_x(9.5, 3, 57, "8.0:1.4 18.0:1.4 26.0:1.0 34.0:1.0 42.0:1.4 52.0:1.4")
  wall_x(30.5, 3, 57, "8.0:1.4 18.0:1.4 30.0:1.4 42.0:1.4 52.0:1.4")
  wall_y(3, 9.5, 30.5, "20.0:1.4")
  wall_y(57, 9.5, 30.5, "20.0:1.4")
  wall_y(22, 9.5, 30.5, "25.0:1.4")
  wall_y(38, 9.5, 30.5, "25.0:1.4")
  wall_x(17, 22, 38, "27.0:1.4 33.0:1.4")
  wall_y(30, 9.5, 17, "")
  # Halls of desks: rows of pairs, back to back.
  for (i = 0; i < 3; ++i)
    for (j = 0; j < 4; ++j) {
      box(6.5 + 5.6 * i, 13.2 + 4.6 * j, 3.2, 1.6, 0)
      box(42.2 + 5.6 * i, 13.2 + 4.6 * j, 3.2, 1.6, 0)
    }
  # Two meeting rooms, and the canteen above them with its counter and round tables.
  box(26, 13.2, 3.6, 1.4, 0)
  box(34, 13.2, 3.6, 1.4, 0)
  box(30, 18.1, 3.0, 0.8, 0)
  for (i = 0; i < 4; ++i) {
    disc(25 + 3.4 * i, 21.4, 0.55)
    disc(25 + 3.4 * i, 27.6, 0.55)
  }
  # Pillars where the aisles between the desks cross.
  for (i = 0; i < 2; ++i)
    for (j = 0; j < 2; ++j) {
      box(9.3 + 5.6 * i, 15.5 + 9.2 * j, 0.5, 0.5, 0)
      box(45.0 + 5.6 * i, 15.5 + 9.2 * j, 0.5, 0.5, 0)
    }
}

function say(line) { comment = comment (line == "" ? "#" : "# " line) "\n" }

BEGIN {
  if (world == "rods") rods()
  else if (world == "clutter") clutter()
  else if (world == "rescue_1") rescue_1()
  else if (world == "rescue_2") rescue_2()
  else if (world == "rescue_3") rescue_3()
  else if (world == "rescue_4") rescue_4()
  else if (world == "office") office()
  else {
    print "draw.awk: -v world= takes rods, clutter, rescue_1 … rescue_4 or office" > "/dev/stderr"
    exit 2
  }
  printf "%s# Drawn by draw.awk: change that, not this. Frame map, x to the right, y up.\n", comment
  printf "kervan_world: 1\nname: %s\n", world
  if (segments != "") printf "segments:\n%s", segments
  if (circles != "") printf "circles:\n%s", circles
  if (boxes != "") printf "boxes:\n%s", boxes
}
