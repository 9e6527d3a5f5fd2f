"""Connected components of what links join."""

from sandbox.physics.jit import kernel


@kernel
def label_bodies(link_a, link_b, label):  # type: ignore[no-untyped-def]
    """Label every node (n,) with the lowest node of its connected component; label holds 0..n-1 at the start."""
    for k in range(link_a.shape[0]):
        a = link_a[k]
        b = link_b[k]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        if a < b:
            label[b] = a
        else:
            label[a] = b
    # Labels never point upwards, so one ascending pass flattens them.
    for node in range(label.shape[0]):
        label[node] = label[label[node]]
