//! Picture files: PNG (8 and 16 bits), Radiance HDR, OpenEXR, PFM.
