"""Certificates: proofs of error bounds that take round-off into account; the command ``study certify``.

A certificate is a file that states a problem, its meshes and a numerical solution in rational numbers. The files of
this package do the following:

* ``statement`` writes the problem and the meshes;
* ``certified`` makes the certificate of one level. It computes numbers that are the same for all solutions on a body,
  the stress element and the constants of the loads, and rounds the displacement and the stress that ``study.bound``
  computes;
* ``checker`` is a stand-alone program that reads a certificate, verifies it in exact arithmetic and computes the
  bounds. So a proof depends on no other file of this package.
"""
