"""Writes the same bodies in every format that Collidoscope reads, with NumPy. Argument: folder."""
import io
import sys

import numpy as np

folder = sys.argv[1] + '/'
n = 500
i = np.arange(n)
x, y, z = (i * 37 % 101) * 0.1, (i * 61 % 103) * 0.1, (i * 17 % 107) * 0.1
r = 0.1 + (i % 7) * 0.05
v = np.c_[(i % 5) * 0.25, (i % 3) * 0.5, -(i % 2) * 1.0]
table = np.c_[x, y, z, r, v]
shuffled = np.random.default_rng(1).permutation(n)

np.save(folder + 'c_order.npy', table)
np.save(folder + 'fortran_order.npy', np.asfortranarray(table))
np.save(folder + 'big_endian.npy', table.astype('>f8'))
np.savez(folder + 'arrays.npz', positions=table[:, :3], radii=r, velocities=v, time=np.arange(9))
np.savez_compressed(folder + 'columns.npz', x=x, y=y, z=z, radius=r, vx=v[:, 0], vy=v[:, 1], vz=v[:, 2])
np.savetxt(folder + 'savetxt.txt', table, fmt='%.17g', header='x y z r vx vy vz')
np.savetxt(folder + 'tabs.tsv', table, fmt='%.17g', delimiter='\t', header='x\ty\tz\tr\tvx\tvy\tvz', comments='')

# Lists: repr() of a number of NumPy 2 is not a number.
x, y, z, r, v = x.tolist(), y.tolist(), z.tolist(), r.tolist(), v.tolist()

with open(folder + 'shuffled.csv', 'w') as file:
    file.write('particle_id,name,Pos_X [m],pos_y,pos_z,diameter,vel_x,vel_y,vel_z\n')
    for k in shuffled:
        file.write(f'{k},"a, b",{x[k]!r},{y[k]!r},{z[k]!r},{2 * r[k]!r},{v[k][0]!r},{v[k][1]!r},{v[k][2]!r}\n')
with open(folder + 'semicolons.csv', 'w', encoding='utf-8-sig', newline='\r\n') as file:
    file.write('Points:0;Points:1;Points:2;radius;v_x;v_y;v_z;note\n')
    for k in range(n):
        file.write(f'{x[k]!r};{y[k]!r}; +{z[k]!r};{r[k]!r};{v[k][0]!r};{v[k][1]!r};{v[k][2]!r};\n')
with open(folder + 'dump.lammpstrj', 'w') as file:
    for frame in range(3):
        file.write(f'ITEM: TIMESTEP\n{frame * 100}\nITEM: NUMBER OF ATOMS\n{n}\nITEM: BOX BOUNDS pp pp ff\n'
                   '0 16\n0 16\n0 16\nITEM: ATOMS id type x y z radius vx vy vz\n')
        for k in shuffled:
            file.write(f'{k + 1} 1 {x[k] + (frame - 1)!r} {y[k]!r} {z[k]!r} {r[k]!r} {v[k][0]!r} {v[k][1]!r} {v[k][2]!r}\n')
with open(folder + 'extended.xyz', 'w') as file:
    file.write(f'{n}\nLattice="16 0 0 0 16 0 0 0 16" Properties=species:S:1:pos:R:3:radius:R:1:velo:R:3 Time=0\n')
    for k in range(n):
        file.write(f'Ar {x[k]!r} {y[k]!r} {z[k]!r} {r[k]!r} {v[k][0]!r} {v[k][1]!r} {v[k][2]!r}\n')

properties = ''.join(f'property double {name}\n' for name in ['x', 'y', 'z', 'radius', 'vx', 'vy', 'vz'])
for name, order in [('little', '<'), ('big', '>')]:
    rows = np.zeros(n, dtype=[('flag', order + 'i2'), ('body', order + 'f8', 7)])
    rows['body'] = table
    with open(folder + name + '.ply', 'wb') as file:
        file.write((f'ply\nformat binary_{name}_endian 1.0\ncomment a comment\nelement camera 1\nproperty uchar kind\n'
                    f'element vertex {n}\nproperty short flag\n{properties}end_header\n').encode())
        file.write(b'\x07' + rows.tobytes())
with open(folder + 'text.ply', 'w') as file:
    file.write(f'ply\nformat ascii 1.0\nelement vertex {n}\n{properties}end_header\n')
    for row in table:
        file.write(' '.join(repr(float(value)) for value in row) + '\n')
np.save(folder + 'objects.npy', np.array([{'a': 1}], dtype=object), allow_pickle=True)

# An archive that claims to be compressed to a millionth.
archive = io.BytesIO()
np.savez_compressed(archive, position=np.zeros((1000, 3)))
data = bytearray(archive.getvalue())
at = data.index(b'PK\x01\x02') + 24  # uncompressed size in the central directory
data[at:at + 4] = (0x7fffffff).to_bytes(4, 'little')
with open(folder + 'bomb.npz', 'wb') as file:
    file.write(data)
