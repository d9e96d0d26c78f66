"""Certificates: proofs of error bounds that hold despite round-off; the command ``study certify``.

``statement`` writes a problem and its meshes in rational numbers. ``constants`` computes the stress element and the
constants of the body, which a certificate states and the checker verifies. ``witnesses`` rounds the displacement and
the stress that ``study.bound`` computes. ``certified`` makes the certificate of one level. ``checker`` is a stand-alone
program that computes the bounds from the certificate alone, so a proof depends on no other file.
"""
