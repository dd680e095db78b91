// Closest and any hit in a 4-wide tree of triangles, one ray per invocation: INTEGRATION.md says how to fill the buffers.

struct Node {
    // Of up to four children; unused ones have lower planes at infinity.
    lower: array<vec4f, 3>,
    upper: array<vec4f, 3>,
    links: vec4u,
    padding: vec4u,
}

// Four triangles, one in each component; unused ones have number NONE.
struct Block {
    v0: array<vec4f, 3>, // first corners
    e1: array<vec4f, 3>, // first corners minus second ones
    e2: array<vec4f, 3>, // third corners minus first ones
    prims: vec4u,
}

struct Ray {
    org: vec3f,
    tnear: f32,
    dir: vec3f,
    tfar: f32,
}

struct Hit {
    t: f32,
    u: f32,
    v: f32,
    prim: u32, // NONE for a miss
}

struct Tree {
    root: u32,
    rays: u32,
}

@group(0) @binding(0) var<storage, read> nodes: array<Node>;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<uniform> tree: Tree;
@group(0) @binding(3) var<storage, read> rays: array<Ray>;
@group(0) @binding(4) var<storage, read_write> hits: array<Hit>;

const NONE = 0xffffffffu;
const LEAF = 0x80000000u;
// Three waiting children per level and one, for 80 levels, the most that a tree may have. Beyond the stack children would be
// lost without a word; where your trees are less deep (WideBvh::depth), a smaller one will do.
const STACK = 241u;
// Distances to far planes grow by more than their rounding.
const WIDEN = 1.0000005;

// No component so small that its reciprocal is infinite: no distance is NaN then.
fn reciprocal(dir: vec3f) -> vec3f {
    return 1.0 / select(dir, vec3f(1e-18), abs(dir) < vec3f(1e-18));
}

// The closest of a block's four triangles, by Moeller and Trumbore; edges belong to their triangles, both sides are hit.
fn test_block(ray: Ray, index: u32, hit: ptr<function, Hit>) {
    let block = blocks[index];
    let c = array(block.v0[0] - ray.org.x, block.v0[1] - ray.org.y, block.v0[2] - ray.org.z);
    let r = array(
        c[1] * ray.dir.z - c[2] * ray.dir.y,
        c[2] * ray.dir.x - c[0] * ray.dir.z,
        c[0] * ray.dir.y - c[1] * ray.dir.x,
    );
    let normal = array(
        block.e2[1] * block.e1[2] - block.e2[2] * block.e1[1],
        block.e2[2] * block.e1[0] - block.e2[0] * block.e1[2],
        block.e2[0] * block.e1[1] - block.e2[1] * block.e1[0],
    );
    let den = normal[0] * ray.dir.x + normal[1] * ray.dir.y + normal[2] * ray.dir.z;
    let u = (r[0] * block.e2[0] + r[1] * block.e2[1] + r[2] * block.e2[2]) / den;
    let v = (r[0] * block.e1[0] + r[1] * block.e1[1] + r[2] * block.e1[2]) / den;
    let t = (normal[0] * c[0] + normal[1] * c[1] + normal[2] * c[2]) / den;
    for (var lane = 0u; lane < 4u; lane++) {
        // Unused lanes, and triangles along the ray, have den = 0.
        let inside = den[lane] != 0.0 && u[lane] >= 0.0 && v[lane] >= 0.0 && u[lane] + v[lane] <= 1.0;
        if inside && ray.tnear < t[lane] && t[lane] <= (*hit).t {
            *hit = Hit(t[lane], u[lane], v[lane], block.prims[lane]);
        }
    }
}

// The closest hit, or any where `first` says that the first one will do.
fn trace(ray: Ray, first: bool) -> Hit {
    let rdir = reciprocal(ray.dir);
    var hit = Hit(ray.tfar, 0.0, 0.0, NONE);
    var links: array<u32, STACK>;
    var entries: array<f32, STACK>;
    var waiting = 0u;
    var link = tree.root;
    loop {
        if (link & LEAF) == 0u {
            var near = vec4f(ray.tnear);
            var far = vec4f(hit.t);
            for (var axis = 0u; axis < 3u; axis++) {
                let a = (nodes[link].lower[axis] - ray.org[axis]) * rdir[axis];
                let b = (nodes[link].upper[axis] - ray.org[axis]) * rdir[axis];
                near = max(near, min(a, b));
                far = min(far, max(a, b) * WIDEN);
            }
            // The children met wait in order, the nearest on top.
            let links_of = nodes[link].links;
            let base = waiting;
            for (var slot = 0u; slot < 4u; slot++) {
                if links_of[slot] != NONE && near[slot] <= far[slot] {
                    var at = waiting;
                    while at > base && entries[at - 1u] < near[slot] {
                        entries[at] = entries[at - 1u];
                        links[at] = links[at - 1u];
                        at--;
                    }
                    entries[at] = near[slot];
                    links[at] = links_of[slot];
                    waiting++;
                }
            }
        } else if link != NONE {
            let block = link & 0x0fffffffu;
            let count = ((link >> 28u) & 7u) + 1u;
            for (var i = 0u; i < count; i++) {
                test_block(ray, block + i, &hit);
            }
            if first && hit.prim != NONE {
                return hit;
            }
        }
        // The next that is not behind the hit.
        loop {
            if waiting == 0u {
                return hit;
            }
            waiting--;
            if entries[waiting] <= hit.t {
                break;
            }
        }
        link = links[waiting];
    }
    return hit;
}

@compute @workgroup_size(64)
fn closest(@builtin(global_invocation_id) id: vec3u) {
    if id.x < tree.rays {
        hits[id.x] = trace(rays[id.x], false);
    }
}

@compute @workgroup_size(64)
fn any(@builtin(global_invocation_id) id: vec3u) {
    if id.x < tree.rays {
        hits[id.x] = trace(rays[id.x], true);
    }
}
